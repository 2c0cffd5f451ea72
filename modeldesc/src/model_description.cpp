// SPDX-License-Identifier: Apache-2.0
#include "mebots/modeldesc/model_description.hpp"

#include <algorithm>

namespace mebots::modeldesc {
namespace {

template <typename T>
const T* find_by_name(const std::vector<T>& list, std::string_view name) {
  const auto found = std::ranges::find(list, name, &T::name);
  return found == list.end() ? nullptr : &*found;
}

}  // namespace

std::string_view to_string(Type type) {
  switch (type) {
    case Type::real:
      return "Real";
    case Type::integer:
      return "Integer";
    case Type::boolean:
      return "Boolean";
    case Type::string:
      return "String";
    case Type::enumeration:
      return "Enumeration";
  }
  return "?";
}

std::string_view to_string(Causality causality) {
  switch (causality) {
    case Causality::parameter:
      return "parameter";
    case Causality::calculated_parameter:
      return "calculatedParameter";
    case Causality::input:
      return "input";
    case Causality::output:
      return "output";
    case Causality::local:
      return "local";
    case Causality::independent:
      return "independent";
  }
  return "?";
}

std::string_view to_string(Variability variability) {
  switch (variability) {
    case Variability::constant:
      return "constant";
    case Variability::fixed:
      return "fixed";
    case Variability::tunable:
      return "tunable";
    case Variability::discrete:
      return "discrete";
    case Variability::continuous:
      return "continuous";
  }
  return "?";
}

std::string_view to_string(Initial initial) {
  switch (initial) {
    case Initial::exact:
      return "exact";
    case Initial::approx:
      return "approx";
    case Initial::calculated:
      return "calculated";
  }
  return "?";
}

const Variable* ModelDescription::find(std::string_view name) const {
  return find_by_name(variables, name);
}
const Unit* ModelDescription::unit(std::string_view name) const {
  return find_by_name(units, name);
}
const TypeDefinition* ModelDescription::type_definition(std::string_view name) const {
  return find_by_name(types, name);
}

}  // namespace mebots::modeldesc
