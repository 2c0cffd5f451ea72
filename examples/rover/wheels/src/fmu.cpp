// SPDX-License-Identifier: Apache-2.0
#include "mebots/fmu/bound_model.hpp"
#include "model.hpp"
#include "rover_wheels/binding.hpp"

namespace mebots::rover_wheels {

std::unique_ptr<fmu::Model> make_model(Variables& variables, fmu::Host& host, std::int64_t start_ns) {
  return std::make_unique<fmu::BoundModel<Model, Variables>>(variables, host, start_ns);
}

}  // namespace mebots::rover_wheels
