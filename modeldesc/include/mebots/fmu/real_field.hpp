// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/fmu/definition.hpp"

#include <cstddef>
#include <string_view>

namespace mebots::fmu {

/// Where an instance keeps a Real variable, for models that learn the names of some of their variables from data. Null
/// when the FMU has no Real variable of this name and causality. `variables` is the instance's generated struct.
inline double* real_field(void* variables, Causality causality, std::string_view name) {
  for (const auto& variable : kDefinition.variables) {
    if (variable.name != name || variable.type != Type::real || variable.causality != causality) continue;
    return reinterpret_cast<double*>(static_cast<std::byte*>(variables) + variable.offset);
  }
  return nullptr;
}

}  // namespace mebots::fmu
