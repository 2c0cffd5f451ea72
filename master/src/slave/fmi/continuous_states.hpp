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
  std::vector<ValueReference> derivatives;  ///< value references of the derivatives
};

/// Throws SlaveError if the variable of a derivative names no state. `instance` is for the message.
ContinuousStates continuous_states_of(const modeldesc::ModelDescription& model, std::string_view instance);

/// Throws SlaveError, because a model exchange instance takes no steps.
[[noreturn]] void fail_to_step(std::string_view instance);

}  // namespace mebots::master
