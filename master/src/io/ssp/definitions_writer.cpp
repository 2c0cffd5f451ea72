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

namespace {

/// Returns the text of a start value. For an enumeration, this is the item's name.
std::string start_text(const modeldesc::ModelDescription& model, const StartValue& start) {
  const auto* number = std::get_if<std::int64_t>(&start.value);
  const auto* type = model.type_definition(start.variable->declared_type);
  if (number != nullptr && type != nullptr) {
    for (const auto& item : type->items) {
      if (item.value == *number) return item.name;
    }
  }
  return value_text(start.variable->type, start.value);
}

}  // namespace

void write_parameter_set(const ResolvedInstance& instance, pugi::xml_document& document) {
  auto set = document.append_child("ssv:ParameterSet");
  set.append_attribute("xmlns:ssv") = "http://ssp-standard.org/SSP1/SystemStructureParameterValues";
  set.append_attribute("xmlns:ssc") = "http://ssp-standard.org/SSP1/SystemStructureCommon";
  set.append_attribute("version") = kWrittenVersion;
  set.append_attribute("name") = "initialValues";  // Ecos and Vico choose a parameter set by this name
  auto parameters = set.append_child("ssv:Parameters");
  DefinitionsWriter definitions;
  const auto& model = *instance.model;
  for (const auto& start : instance.starts) {
    auto parameter = parameters.append_child("ssv:Parameter");
    parameter.append_attribute("name") = start.variable->name.c_str();
    auto type = parameter.append_child(fmt::format("ssv:{}", modeldesc::to_string(start.variable->type)).c_str());
    type.append_attribute("value") = start_text(model, start).c_str();
    const auto unit = definitions.unit_of(model, *start.variable);
    if (!unit.empty()) type.append_attribute("unit") = unit.c_str();
    if (start.variable->type != modeldesc::Type::enumeration) continue;
    type.append_attribute("name") = start.variable->declared_type.c_str();
    definitions.add_enumeration(model, *start.variable);
  }
  definitions.write(set, "ssv:");
}

}  // namespace mebots::master::ssp
