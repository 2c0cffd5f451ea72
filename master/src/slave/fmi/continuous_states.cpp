// SPDX-License-Identifier: Apache-2.0
#include "slave/fmi/continuous_states.hpp"

#include "slave/slave.hpp"

#include <fmt/format.h>

namespace mebots::master {

ContinuousStates continuous_states_of(const modeldesc::ModelDescription& model, std::string_view instance) {
  ContinuousStates states;
  for (const auto& derivative : model.derivatives) {
    const auto& rate = model.variables[derivative.variable];
    if (!rate.derivative_of) {
      throw SlaveError(ErrorCode::fmu_inconsistent,
                       fmt::format("instance '{}': '{}' is a derivative in ModelStructure, but its variable has no "
                                   "attribute derivative, which names the state",
                                   instance, rate.name));
    }
    const auto& state = model.variables[*rate.derivative_of];
    states.names.push_back(state.name);
    states.references.push_back(state.value_reference);
    states.derivatives.push_back(rate.value_reference);
  }
  return states;
}

void fail_to_step(std::string_view instance) {
  throw SlaveError(ErrorCode::wrong_call_order,
                   fmt::format("instance '{}' is for model exchange and cannot take steps", instance));
}

}  // namespace mebots::master
