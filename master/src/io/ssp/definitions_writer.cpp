// SPDX-License-Identifier: Apache-2.0
#include "definitions_writer.hpp"

#include <fmt/format.h>

namespace mebots::master::ssp {

std::string DefinitionsWriter::unit_of(const modeldesc::ModelDescription& model, const modeldesc::Variable& variable) {
  const auto* unit = model.unit(variable.unit);
  if (variable.type != modeldesc::Type::real || unit == nullptr || !unit->has_base) return {};
  const auto [known, added] = units_.emplace(unit->name, unit);
  return added || modeldesc::same_unit(*known->second, *unit) ? unit->name : std::string();
}

void DefinitionsWriter::add_enumeration(const modeldesc::ModelDescription& model, const modeldesc::Variable& variable) {
  const auto* definition = model.type_definition(variable.declared_type);
  if (definition != nullptr) enumerations_.emplace(definition->name, definition);
}

void DefinitionsWriter::write(pugi::xml_node root, const std::string& prefix) const {
  if (!enumerations_.empty()) {
    auto enumerations = root.append_child((prefix + "Enumerations").c_str());
    for (const auto& [name, type] : enumerations_) {
      auto enumeration = enumerations.append_child("ssc:Enumeration");
      enumeration.append_attribute("name") = name.c_str();
      for (const auto& item : type->items) {
        auto node = enumeration.append_child("ssc:Item");
        node.append_attribute("name") = item.name.c_str();
        node.append_attribute("value") = item.value;
      }
    }
  }
  if (units_.empty()) return;
  auto units = root.append_child((prefix + "Units").c_str());
  for (const auto& [name, unit] : units_) {
    auto node = units.append_child("ssc:Unit");
    node.append_attribute("name") = name.c_str();
    auto base = node.append_child("ssc:BaseUnit");
    for (std::size_t i = 0; i < modeldesc::kBaseUnits.size(); ++i) {
      if (unit->exponents[i] != 0) {
        base.append_attribute(std::string(modeldesc::kBaseUnits[i]).c_str()) = unit->exponents[i];
      }
    }
    if (unit->factor != 1) base.append_attribute("factor") = fmt::format("{}", unit->factor).c_str();
    if (unit->offset != 0) base.append_attribute("offset") = fmt::format("{}", unit->offset).c_str();
  }
}

}  // namespace mebots::master::ssp
