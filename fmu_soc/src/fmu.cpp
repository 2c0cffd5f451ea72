// SPDX-License-Identifier: Apache-2.0
#include "fmu_soc/binding.hpp"
#include "mebots/fmu/bound_model.hpp"
#include "mebots/fmu/real_field.hpp"
#include "model.hpp"

namespace mebots::soc {

std::unique_ptr<fmu::Model> make_model(Variables& variables, fmu::Host& host, std::int64_t start_ns) {
  Listeners listeners;
  listeners.console = [&host](std::string_view line) { host.log(fmu::Severity::info, "console", line); };
  listeners.faults = [&host](std::string_view text) { host.log(fmu::Severity::warning, "faults", text); };
  listeners.observe = [&host](std::string_view text) { host.log(fmu::Severity::warning, "observe", text); };
  const Fields fields{
      [&variables](std::string_view name) { return fmu::real_field(&variables, fmu::Causality::input, name); },
      [&variables](std::string_view name) { return fmu::real_field(&variables, fmu::Causality::output, name); }};
  return std::make_unique<fmu::BoundModel<Model, Variables>>(variables, host, start_ns, listeners, fields);
}

}  // namespace mebots::soc
