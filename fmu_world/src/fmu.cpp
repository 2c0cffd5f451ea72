// SPDX-License-Identifier: Apache-2.0
#include "fmu_world/binding.hpp"
#include "mebots/base64.hpp"
#include "mebots/data/find_file.hpp"
#include "model.hpp"
#include "scene/load.hpp"

namespace mebots::world {
namespace {

class Binding final : public fmu::Model {
 public:
  Binding(Variables& variables, fmu::Host& host, std::int64_t start_ns)
      : world_(
            read_scene(variables.parameters, host), variables.parameters, variables.inputs, variables.outputs,
            [&host](std::string_view event) { host.log(fmu::Severity::info, "events", event); }, start_ns) {}

  void step(std::int64_t start_ns, std::int64_t duration_ns) override { world_.step(start_ns, duration_ns); }
  void visit(state::Visitor& v) override { world_.visit(v); }
  std::string on_demand_text(std::string_view name) const override {
    return name == "view.scene" ? world_.view() : encode_base64(world_.frame());
  }

 private:
  static scene::Scene read_scene(const Parameters& parameters, const fmu::Host& host) {
    auto scene = scene::load_scene(data::find_file(host.resources() / "scenes", parameters.scene_name, "scene.name"));
    if (!parameters.drone_name.empty()) {
      scene.drone =
          scene::load_drone(data::find_file(host.resources() / "drones", parameters.drone_name, "drone.name"));
    }
    return scene;
  }

  World world_;
};

}  // namespace

std::unique_ptr<fmu::Model> make_model(Variables& variables, fmu::Host& host, std::int64_t start_ns) {
  return std::make_unique<Binding>(variables, host, start_ns);
}

}  // namespace mebots::world

/// Static memory contains constants, the tiles of existing worlds, and ODE's data while a world exists.
// NOLINTNEXTLINE(readability-identifier-naming): the name that docs/master/clean-fmus.md gives
extern "C" [[gnu::visibility("default")]] const char mebots_keeps_no_state_outside_instances = 1;
