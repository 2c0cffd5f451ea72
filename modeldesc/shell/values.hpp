// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "face.hpp"
#include "mebots/assert.hpp"
#include "mebots/fmi2/types.hpp"
#include "mebots/state/visitor.hpp"

#include <string>

/// Typed access to an instance's variables by the offsets in the table, and their checks.
namespace mebots::shell {

template <typename T>
T& field(void* variables, const Variable& variable) {
  MEBOTS_ASSERT(variable.offset != kNoField, "it is made when read");
  return *reinterpret_cast<T*>(static_cast<std::byte*>(variables) + variable.offset);
}

template <typename T>
const T& field(const void* variables, const Variable& variable) {
  MEBOTS_ASSERT(variable.offset != kNoField, "it is made when read");
  return *reinterpret_cast<const T*>(static_cast<const std::byte*>(variables) + variable.offset);
}

/// The variable of this reference if it is of this type (enumerations count as Integer). Throws mebots::Error.
const Variable& find_variable(const Definition& definition, fmi2ValueReference reference, Type type);

/// Throw mebots::Error naming variable, value and limit when the value may not be set.
void check_value(const Variable& variable, fmi2Real value);
void check_value(const Variable& variable, fmi2Integer value);
void check_boolean(const Variable& variable, fmi2Boolean value);
void check_value(const Variable& variable, fmi2String value);

/// All values of one causality as states hold them, by their FMI names. Pointers are not among them: they become null
/// when the others are restored.
class KeptValues {
 public:
  KeptValues(const Definition& definition, Causality causality, void* variables)
      : definition_(definition), causality_(causality), variables_(variables) {}

  void visit(state::Visitor& v);

 private:
  const Definition& definition_;
  Causality causality_;
  void* variables_;
};

/// Copies the values of one causality from other variables of the same definition, pointers too.
void copy_values(const Definition& definition, Causality causality, const void* from, void* to);

}  // namespace mebots::shell
