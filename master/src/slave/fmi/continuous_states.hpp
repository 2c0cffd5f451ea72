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
  std::vector<ValueReference> derivatives;  ///< value references of the derivatives
};

/// Returns the continuous states of a model. Throws SlaveError if a derivative does not refer to a state. `instance`
/// names the instance in the error.
ContinuousStates continuous_states_of(const modeldesc::ModelDescription& model, std::string_view instance);

/// Throws SlaveError. Called if a step of a model exchange instance is requested, because such an instance performs
/// none.
[[noreturn]] void fail_to_step(std::string_view instance);

}  // namespace mebots::master
