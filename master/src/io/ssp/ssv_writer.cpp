// SPDX-License-Identifier: Apache-2.0
#include "ssv_writer.hpp"

#include "definitions_writer.hpp"

#include <fmt/format.h>

namespace mebots::master::ssp {
namespace {

/// The item's name for an enumeration.
std::string start_text(const modeldesc::ModelDescription& model, const StartValue& start) {
  const auto* number = std::get_if<std::int32_t>(&start.value);
  const auto* type = model.type_definition(start.variable->declared_type);
  if (number != nullptr && type != nullptr) {
    for (const auto& item : type->items) {
      if (item.value == *number) return item.name;
    }
  }
  return value_text(start.value);
}

}  // namespace

void write_parameter_set(const ResolvedInstance& instance, pugi::xml_document& document) {
  auto set = document.append_child("ssv:ParameterSet");
  set.append_attribute("xmlns:ssv") = "http://ssp-standard.org/SSP1/SystemStructureParameterValues";
  set.append_attribute("xmlns:ssc") = "http://ssp-standard.org/SSP1/SystemStructureCommon";
  set.append_attribute("version") = kWrittenVersion;
  set.append_attribute("name") = "initialValues";  // Ecos and Vico choose among parameter sets by this name
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
