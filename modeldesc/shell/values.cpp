// SPDX-License-Identifier: Apache-2.0
#include "values.hpp"

#include "mebots/assert.hpp"
#include "mebots/error.hpp"
#include "mebots/fmu/binary_ref.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace mebots::shell {
namespace {

std::string with_unit(double value, const Variable& variable) {
  return variable.unit.empty() || variable.unit == "1" ? fmt::format("{}", value)
                                                       : fmt::format("{} {}", value, variable.unit);
}

void check_limits(const Variable& variable, double value) {
  if (value < variable.min)
    throw Error(fmt::format("{} = {} is below its minimum of {}", variable.name, with_unit(value, variable),
                            with_unit(variable.min, variable)));
  if (value > variable.max)
    throw Error(fmt::format("{} = {} is above its maximum of {}", variable.name, with_unit(value, variable),
                            with_unit(variable.max, variable)));
}

/// Calls `action` for each variable of the causality, except variables for which the generated structs have no field.
template <typename Action>
void for_each_field(const Definition& definition, Causality causality, Action action) {
  for (const Variable& variable : definition.variables)
    if (variable.causality == causality && variable.offset != kNoField) action(variable);
}

/// Calls `action` with a null pointer whose type is a pointer to the C++ type of the field.
template <typename Action>
void with_type(Type type, Action action) {
  switch (type) {
    case Type::real:
      return action(static_cast<double*>(nullptr));
    case Type::integer:
    case Type::enumeration:
      return action(static_cast<std::int32_t*>(nullptr));
    case Type::boolean:
      return action(static_cast<bool*>(nullptr));
    case Type::string:
      return action(static_cast<std::string*>(nullptr));
    default:
      MEBOTS_ASSERT(false, "the fields of our variables have no other types");
  }
}

}  // namespace

const Variable& find_variable(const Definition& definition, fmi2ValueReference reference, Type type) {
  const auto count = definition.variables.size();
  if (reference >= count)
    throw Error(fmt::format("there is no value reference {}; {} has 0 to {}", reference, definition.model_identifier,
                            static_cast<std::ptrdiff_t>(count) - 1));
  const Variable& variable = definition.variables[reference];
  const Type read_as = variable.type == Type::enumeration ? Type::integer : variable.type;
  if (read_as != type)
    throw Error(fmt::format("value reference {} is {} of type {}, not {}; use the functions for {}", reference,
                            variable.name, to_string(variable.type), to_string(type), to_string(read_as)));
  return variable;
}

void check_value(const Variable& variable, fmi2Real value) {
  if (!std::isfinite(value)) throw Error(fmt::format("{} = {}: a finite number is needed", variable.name, value));
  check_limits(variable, value);
}

void check_value(const Variable& variable, fmi2Integer value) {
  check_limits(variable, value);
  if (variable.type != Type::enumeration) return;
  if (std::ranges::find(variable.items, value, &EnumerationItem::value) != variable.items.end()) return;
  std::string known;
  for (const EnumerationItem& item : variable.items)
    known += fmt::format("{}{} = {}", known.empty() ? "" : ", ", item.value, item.name);
  throw Error(fmt::format("{} = {} is not one of its values ({})", variable.name, value, known));
}

void check_boolean(const Variable& variable, fmi2Boolean value) {
  if (value != fmi2True && value != fmi2False)
    throw Error(fmt::format("{} = {}: a Boolean is 0 or 1", variable.name, value));
}

void check_value(const Variable& variable, fmi2String value) {
  if (value == nullptr) throw Error(fmt::format("{}: the text is a null pointer", variable.name));
}

void KeptValues::visit(state::Visitor& v) {
  for_each_field(definition_, causality_, [&](const Variable& variable) {
    if (!variable.is_pointer)
      with_type(variable.type, [&]<typename T>(T*) { v(variable.name, field<T>(variables_, variable)); });
    else
      visit_pointer(v, variable);
  });
}

void KeptValues::visit_pointer(state::Visitor& v, const Variable& variable) {
  const bool is_first = variable.name.ends_with(".base.lo");
  if (binaries_ == nullptr || !is_first) {
    if (v.restores() && binaries_ == nullptr) field<std::int32_t>(variables_, variable) = 0;
    return;
  }
  auto& bytes = (*binaries_)[static_cast<fmi2ValueReference>(&variable - definition_.variables.data())];
  v(variable.name, bytes);
  static_assert(offsetof(fmu::BinaryRef, base_lo) == 0);
  if (v.restores()) field<fmu::BinaryRef>(variables_, variable) = fmu::BinaryRef::to(bytes);
}

void copy_values(const Definition& definition, Causality causality, const void* from, void* to) {
  for_each_field(definition, causality, [&](const Variable& variable) {
    with_type(variable.type, [&]<typename T>(T*) { field<T>(to, variable) = field<T>(from, variable); });
  });
}

}  // namespace mebots::shell
