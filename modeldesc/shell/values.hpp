// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "face.hpp"
#include "mebots/fmi2/types.hpp"
#include "mebots/state/bytes.hpp"

#include <string>

/// Typed access to an instance's variables by the offsets in the table, and their checks.
namespace mebots::shell {

template <typename T>
T& field(void* variables, const Variable& variable) {
  return *reinterpret_cast<T*>(static_cast<std::byte*>(variables) + variable.offset);
}

template <typename T>
const T& field(const void* variables, const Variable& variable) {
  return *reinterpret_cast<const T*>(static_cast<const std::byte*>(variables) + variable.offset);
}

/// The variable of this reference if it is of this type (enumerations count as Integer). Throws mebots::Error.
const Variable& find_variable(const Definition& definition, fmi2ValueReference reference, Type type);

/// Throw mebots::Error naming variable, value and limit when the value may not be set.
void check_value(const Variable& variable, fmi2Real value);
void check_value(const Variable& variable, fmi2Integer value);
void check_boolean(const Variable& variable, fmi2Boolean value);
void check_value(const Variable& variable, fmi2String value);

/// All values of one causality as bytes, pointers left out.
void save_values(const Definition& definition, Causality causality, const void* variables, state::Writer& writer);
/// Reads them back; pointers become null.
void restore_values(const Definition& definition, Causality causality, void* variables, state::Reader& reader);
/// Copies the values of one causality from other variables of the same definition, pointers too.
void copy_values(const Definition& definition, Causality causality, const void* from, void* to);

}  // namespace mebots::shell
