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
