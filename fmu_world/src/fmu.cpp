// SPDX-License-Identifier: Apache-2.0
#include "fmu_world/binding.hpp"
#include "mebots/base64.hpp"
#include "mebots/data/find_file.hpp"
#include "mebots/error.hpp"
#include "mebots/file_kind.hpp"
#include "model.hpp"
#include "scene/downwash_networks.hpp"
#include "scene/load.hpp"

#include <fmt/format.h>
#include <charconv>
#include <optional>
#include <string>
#include <vector>

namespace mebots::world {
namespace {

class Binding final : public fmu::Model {
 public:
  Binding(Variables& variables, fmu::Host& host, std::int64_t start_ns)
      : Binding(variables, host, start_ns, read_scene(variables.parameters, host)) {}

  void step(std::int64_t start_ns, std::int64_t duration_ns) override { world_.step(start_ns, duration_ns); }
  void visit(state::Visitor& v) override { world_.visit(v); }
  std::string on_demand_text(std::string_view name) const override {
    if (name == "view.scene") return world_.view();
    const CameraDevice* camera = world_.camera(index_in(name));
    if (camera == nullptr) return {};
    if (name.ends_with("camera.objects")) return camera->objects_text();
    return encode_base64(name.ends_with("camera.depth.base64") ? camera->depth() : camera->frame());
  }

 private:
  Binding(Variables& variables, fmu::Host& host, std::int64_t start_ns, const scene::Scene& scene)
      : world_(
            scene, variables.parameters, variables.inputs, variables.outputs, drones_of(variables, scene, host),
            [&host](std::string_view event) { host.log(fmu::Severity::info, "events", event); }, start_ns,
            read_networks(variables.parameters.downwash_networks)) {}

  static scene::Scene read_scene(const Parameters& parameters, const fmu::Host& host) {
    return scene::load_scene(data::find_file(host.resources() / "scenes", parameters.scene_name, "scene.name"));
  }

  static scene::Drone read_drone(const std::string& name, const scene::Scene& scene, const fmu::Host& host) {
    if (name.empty()) return scene.drone;
    return scene::load_drone(data::find_file(host.resources() / "drones", name, "drone.name"));
  }

  static std::optional<scene::DownwashNetworks> read_networks(const std::string& file) {
    if (file.empty()) return {};
    if (!is_file(file)) {
      throw Error(ErrorCode::file_not_found,
                  fmt::format("downwash.networks = \"{}\": there is no such file. Write one from your copy of the "
                              "networks with scripts/downwash_networks.py, or leave the parameter empty",
                              file));
    }
    return scene::load_downwash_networks(file);
  }

  static std::vector<DroneSetup> drones_of(Variables& variables, const scene::Scene& scene, const fmu::Host& host) {
    const bool has_many = variables.drone.size() > 1;
    std::vector<DroneSetup> drones;
    for (std::size_t i = 0; i < static_cast<std::size_t>(variables.parameters.drone_count); ++i) {
      DroneVariables& own = variables.drone.at(i);
      drones.push_back({has_many ? fmt::format("drone[{}]", i + 1) : "",
                        read_drone(own.parameters.drone_name, scene, host), own.parameters, own.inputs, own.outputs});
    }
    return drones;
  }

  /// Returns the index in a name, counted from 0: 1 for "drone[2].camera.frame.base64". Without an index, returns 0.
  static std::size_t index_in(std::string_view name) {
    const auto open = name.find('[');
    if (open == std::string_view::npos) return 0;
    std::size_t number = 1;
    std::from_chars(name.data() + open + 1, name.data() + name.size(), number);
    return number - 1;
  }

  World world_;
};

}  // namespace

std::unique_ptr<fmu::Model> make_model(Variables& variables, fmu::Host& host, std::int64_t start_ns) {
  return std::make_unique<Binding>(variables, host, start_ns);
}

}  // namespace mebots::world

/// Declares that the library keeps no state outside of instances. Its static memory contains only constants, the tiles
/// of existing worlds, and ODE's data while a world exists.
// NOLINTNEXTLINE(readability-identifier-naming): the name that docs/master/clean-fmus.md gives
extern "C" [[gnu::visibility("default")]] const char mebots_keeps_no_state_outside_instances = 1;
