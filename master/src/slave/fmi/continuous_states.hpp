// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/value_kind.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace mebots::master {

/// The continuous states of a model, in the order of its derivatives in ModelStructure.
struct ContinuousStates {
  std::vector<std::string> names;
  std::vector<ValueReference> references;
  std::vector<ValueReference> derivatives;  ///< references of the derivatives
};

/// Throws SlaveError for a derivative whose variable names no state. `instance` is for the message.
ContinuousStates continuous_states_of(const modeldesc::ModelDescription& model, std::string_view instance);

/// Throws SlaveError: an instance of model exchange takes no steps.
[[noreturn]] void fail_to_step(std::string_view instance);

}  // namespace mebots::master
