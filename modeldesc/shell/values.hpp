// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "face.hpp"
#include "mebots/assert.hpp"
#include "mebots/fmi2/types.hpp"
#include "mebots/state/visitor.hpp"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

/// Accesses an instance's variables by their offsets in the variable table, with checks of types and limits.
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

/// Returns the variable with this reference. Throws mebots::Error if the variable does not exist or has another type
/// (enumerations count as Integer).
const Variable& find_variable(const Definition& definition, fmi2ValueReference reference, Type type);

/// These functions throw mebots::Error with variable, value and limit if the value may not be set.
void check_value(const Variable& variable, fmi2Real value);
void check_value(const Variable& variable, fmi2Integer value);
void check_boolean(const Variable& variable, fmi2Boolean value);
void check_value(const Variable& variable, fmi2String value);

/// The instance's own copies of binary inputs. An input consists of three variables (address low, address high, size).
/// The key is the value reference of the first of them.
using Binaries = std::map<fmi2ValueReference, std::vector<std::uint8_t>>;

/// All values of one causality, by FMI name, as saved states contain them. Pointers are not saved. After a restore,
/// pointers of inputs point into `binaries`, whose contents are saved. All other pointers are null. If `binaries` is
/// null, all pointers are null.
class KeptValues {
 public:
  KeptValues(const Definition& definition, Causality causality, void* variables, Binaries* binaries)
      : definition_(definition),
        causality_(causality),
        variables_(variables),
        binaries_(causality == Causality::input ? binaries : nullptr) {}

  void visit(state::Visitor& v);

 private:
  void visit_pointer(state::Visitor& v, const Variable& variable);

  const Definition& definition_;
  Causality causality_;
  void* variables_;
  Binaries* binaries_;
};

/// Copies the values of one causality, pointers included, from other variables of the same definition.
void copy_values(const Definition& definition, Causality causality, const void* from, void* to);

}  // namespace mebots::shell
