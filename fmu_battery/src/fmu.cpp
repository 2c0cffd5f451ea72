// SPDX-License-Identifier: Apache-2.0
#include "fmu_battery/binding.hpp"
#include "mebots/fmu/bound_model.hpp"
#include "model.hpp"

namespace mebots::battery {

std::unique_ptr<fmu::Model> make_model(Variables& variables, fmu::Host& host, std::int64_t start_ns) {
  const auto report = [&host](Model::Message kind, std::string_view text) {
    host.log(kind == Model::Message::event ? fmu::Severity::info : fmu::Severity::warning, "events", text);
  };
  return std::make_unique<fmu::BoundModel<Model, Variables>>(variables, host, start_ns, report);
}

}  // namespace mebots::battery
