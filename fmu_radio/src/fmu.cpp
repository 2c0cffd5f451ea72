// SPDX-License-Identifier: Apache-2.0
#include "fmu_radio/binding.hpp"
#include "mebots/fmu/model.hpp"
#include "model.hpp"

namespace mebots::radio {
namespace {

class Binding final : public fmu::Model {
 public:
  Binding(Variables& variables, fmu::Host& host, std::int64_t start_ns)
      : model_(variables.parameters, variables.node, start_ns,
               [&host](std::string_view message) { host.log(fmu::Severity::warning, "events", message); }) {}

  void step(std::int64_t start_ns, std::int64_t duration_ns) override { model_.step(start_ns, duration_ns); }
  void visit(state::Visitor& v) override { model_.visit(v); }

 private:
  radio::Model model_;
};

}  // namespace

std::unique_ptr<fmu::Model> make_model(Variables& variables, fmu::Host& host, std::int64_t start_ns) {
  return std::make_unique<Binding>(variables, host, start_ns);
}

}  // namespace mebots::radio
