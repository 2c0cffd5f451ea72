// SPDX-License-Identifier: Apache-2.0
#include "fmu_soc/binding.hpp"
#include "model.hpp"

namespace mebots::soc {
namespace {

Listeners listeners_of(shell::Host& host) {
  Listeners listeners;
  listeners.console = [&host](std::string_view line) { host.log(shell::Severity::info, "console", line); };
  listeners.faults = [&host](std::string_view text) { host.log(shell::Severity::warning, "faults", text); };
  listeners.observe = [&host](std::string_view text) { host.log(shell::Severity::warning, "observe", text); };
  return listeners;
}

class Binding final : public shell::Model {
 public:
  Binding(Variables& variables, shell::Host& host, std::int64_t start_ns)
      : variables_(variables), model_(variables.parameters, host.resources(), listeners_of(host)) {
    model_.start(variables_.inputs, start_ns, variables_.outputs);
  }

  void step(std::int64_t start_ns, std::int64_t duration_ns) override {
    model_.step(variables_.inputs, start_ns, duration_ns, variables_.outputs);
  }
  void save(state::Writer& writer) const override { model_.save(writer); }
  void restore(state::Reader& reader) override { model_.restore(reader); }

 private:
  Variables& variables_;
  soc::Model model_;
};

}  // namespace

std::unique_ptr<shell::Model> make_model(Variables& variables, shell::Host& host, std::int64_t start_ns) {
  return std::make_unique<Binding>(variables, host, start_ns);
}

}  // namespace mebots::soc
