// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/fmu/binary_ref.hpp"
#include "mebots/fmu/definition.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

/// Finds an instance's variables by name, for models that read names from data files. `variables` points to the
/// instance's generated struct. The results are valid as long as this struct.
namespace mebots::fmu {

/// Refers to a numeric variable of any type. A Boolean reads as 0 or 1, an enumeration as the number of its item.
class NumberField {
 public:
  NumberField(Type type, void* at) : type_(type), at_(at) {}

  double get() const {
    if (type_ == Type::real) return *static_cast<const double*>(at_);
    if (type_ == Type::boolean) return *static_cast<const bool*>(at_) ? 1 : 0;
    return *static_cast<const std::int32_t*>(at_);
  }
  void set(double value) const {
    if (type_ == Type::real) {
      *static_cast<double*>(at_) = value;
    } else if (type_ == Type::boolean) {
      *static_cast<bool*>(at_) = value != 0;
    } else {
      *static_cast<std::int32_t*>(at_) = static_cast<std::int32_t>(value);
    }
  }

 private:
  Type type_;
  void* at_;
};

/// Returns the variable with this name and causality. Returns null if it does not exist, or if the generated structs
/// have no field for it.
inline const Variable* find_variable(Causality causality, std::string_view name) {
  for (const auto& variable : kDefinition.variables) {
    if (variable.name == name && variable.causality == causality && variable.offset != kNoField) return &variable;
  }
  return nullptr;
}

inline std::optional<NumberField> number_field(void* variables, Causality causality, std::string_view name) {
  const auto* found = find_variable(causality, name);
  if (found == nullptr || found->type == Type::string) return std::nullopt;
  return NumberField(found->type, static_cast<std::byte*>(variables) + found->offset);
}

inline std::string* text_field(void* variables, Causality causality, std::string_view name) {
  const auto* found = find_variable(causality, name);
  if (found == nullptr || found->type != Type::string) return nullptr;
  return reinterpret_cast<std::string*>(static_cast<std::byte*>(variables) + found->offset);
}

/// Returns the OSMP binary variable with this name and causality; null if it does not exist. The names of its three
/// Integer variables begin with `name`.
inline const BinaryRef* binary_field(const void* variables, Causality causality, std::string_view name) {
  const auto* found = find_variable(causality, std::string(name) + ".base.lo");
  if (found == nullptr || !found->is_pointer) return nullptr;
  static_assert(offsetof(BinaryRef, base_lo) == 0);
  return reinterpret_cast<const BinaryRef*>(static_cast<const std::byte*>(variables) + found->offset);
}

}  // namespace mebots::fmu
