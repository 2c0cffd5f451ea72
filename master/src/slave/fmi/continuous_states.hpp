// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/value_kind.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace mebots::master {

/// The continuous states of a model, in the order in which ModelStructure lists their derivatives.
struct ContinuousStates {
  std::vector<std::string> names;
  std::vector<ValueReference> references;
  std::vector<ValueReference> derivatives;
};

/// Returns the continuous states of a model. Throws SlaveError with the name `instance` if a derivative does not refer
/// to a state.
ContinuousStates continuous_states_of(const modeldesc::ModelDescription& model, std::string_view instance);

/// Throws SlaveError, because a model exchange instance cannot perform a step.
[[noreturn]] void fail_to_step(std::string_view instance);

}  // namespace mebots::master
