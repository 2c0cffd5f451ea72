// SPDX-License-Identifier: Apache-2.0
#include "fmu_soc/binding.hpp"
#include "mebots/shell/bound_model.hpp"
#include "mebots/shell/fields.hpp"
#include "model.hpp"

namespace mebots::soc {

std::unique_ptr<shell::Model> make_model(Variables& variables, shell::Host& host, std::int64_t start_ns) {
  Listeners listeners;
  listeners.console = [&host](std::string_view line) { host.log(shell::Severity::info, "console", line); };
  listeners.faults = [&host](std::string_view text) { host.log(shell::Severity::warning, "faults", text); };
  listeners.observe = [&host](std::string_view text) { host.log(shell::Severity::warning, "observe", text); };
  const Fields fields{
      [&variables](std::string_view name) { return shell::real_field(&variables, shell::Causality::input, name); },
      [&variables](std::string_view name) { return shell::real_field(&variables, shell::Causality::output, name); }};
  return std::make_unique<shell::BoundModel<Model, Variables>>(variables, host, start_ns, listeners, fields);
}

}  // namespace mebots::soc
