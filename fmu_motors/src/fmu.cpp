// SPDX-License-Identifier: Apache-2.0
#include "fmu_motors/binding.hpp"
#include "mebots/fmu/bound_model.hpp"
#include "model.hpp"

namespace mebots::motors {

std::unique_ptr<fmu::Model> make_model(Variables& variables, fmu::Host& host, std::int64_t start_ns) {
  const auto report = [&host](std::string_view message) { host.log(fmu::Severity::warning, "events", message); };
  return std::make_unique<fmu::BoundModel<Model, Variables>>(variables, host, start_ns, report);
}

}  // namespace mebots::motors
