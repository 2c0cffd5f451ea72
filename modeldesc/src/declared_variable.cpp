// SPDX-License-Identifier: Apache-2.0
#include "mebots/modeldesc/declared_variable.hpp"

#include "mebots/parsed_number.hpp"

#include <algorithm>

namespace mebots::modeldesc {
namespace {

/// True if some values of the structural parameters give the array this element. `indices` is the part of an element's
/// name in brackets, such as "2,3".
bool may_have_element(const Variable& array, std::string_view indices) {
  const auto& dimensions = array.fmi3->dimensions;
  if (dimensions.size() != static_cast<std::size_t>(std::ranges::count(indices, ',')) + 1) return false;
  for (const auto& dimension : dimensions) {
    const auto comma = std::min(indices.find(','), indices.size());
    const auto index = parsed_number<std::uint64_t>(indices.substr(0, comma));
    if (!index || *index == 0 || (dimension.start && *index > *dimension.start)) return false;
    indices.remove_prefix(std::min(comma + 1, indices.size()));
  }
  return true;
}

}  // namespace

const Variable* declared_variable(const ModelDescription& description, std::string_view name) {
  if (const auto* variable = description.find(name)) return variable;
  const auto bracket = name.rfind('[');
  if (!name.ends_with(']') || bracket == std::string_view::npos) return nullptr;
  const auto* array = description.find(name.substr(0, bracket));
  if (array == nullptr || !may_have_element(*array, name.substr(bracket + 1, name.size() - bracket - 2)))
    return nullptr;
  return array;
}

}  // namespace mebots::modeldesc
