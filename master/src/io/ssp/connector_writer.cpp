// SPDX-License-Identifier: Apache-2.0
#include "connector_writer.hpp"

#include "model/value_kind.hpp"

#include "xml_file.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace mebots::master::ssp {
namespace {

using modeldesc::Causality;
using modeldesc::Type;

const char* kind_of_connector(Causality causality) {
  switch (causality) {
    case Causality::input:
      return "input";
    case Causality::output:
      return "output";
    case Causality::calculated_parameter:
      return "calculatedParameter";
    case Causality::structural_parameter:
      return "structuralParameter";
    case Causality::parameter:
    case Causality::local:
    case Causality::independent:
    case Causality::dependent:
      break;
  }
  return "parameter";
}

}  // namespace

std::string indices_of(const modeldesc::Variable& element) {
  auto indices = element.name.substr(element.fmi3->element->array.size());
  std::erase_if(indices, [](char c) { return c == '[' || c == ']'; });
  std::ranges::replace(indices, ',', ' ');
  return indices;
}

void write_dimensions(pugi::xml_node node, const std::string& sizes) {
  for (const auto& size : words_of(sizes)) node.append_child("ssc:Dimension").append_attribute("size") = size.c_str();
}

ConnectorWriter::ConnectorWriter(const ResolvedSystem& system)
    : system_(&system), arrays_(system.instances.size()), connectors_(system.instances.size()) {
  for (std::size_t i = 0; i < system.instances.size(); ++i) {
    for (const auto& variable : system.instances[i].model->variables) {
      if (const auto& element = variable.fmi3->element; element && element->index + 1 == element->count)
        arrays_[i][element->array] = {&variable, indices_of(variable), false};
    }
  }
}

bool ConnectorWriter::is_osmp(const VariableName& name) const {
  const auto instance = *system_->description->index_of(name.instance);
  return system_->instances[instance].model->find(name.variable) == nullptr &&
         !arrays_[instance].contains(name.variable);
}

WrittenEnd ConnectorWriter::end_of(const VariableName& name) {
  const auto instance = *system_->description->index_of(name.instance);
  const auto& model = *system_->instances[instance].model;
  const auto* variable = model.find(name.variable);
  WrittenEnd end{instance, name.variable, {}};
  auto& connectors = connectors_[instance];
  if (variable != nullptr && variable->fmi3->element) {
    end.connector = variable->fmi3->element->array;
    end.indices = indices_of(*variable);
  }
  if (const auto array = arrays_[instance].find(end.connector); array != arrays_[instance].end()) {
    connectors.insert(*array);
  } else if (variable != nullptr) {
    connectors[end.connector] = {variable, {}, false};
  } else {
    connectors[end.connector] = {model.find(name.variable + kOsmpEndings[0]), {}, true};
  }
  return end;
}

std::vector<std::pair<WrittenEnd, WrittenEnd>> ConnectorWriter::ends(const ConnectionDescription& connection) {
  if (!is_osmp(connection.from) || !is_osmp(connection.to)) return {{end_of(connection.from), end_of(connection.to)}};
  std::vector<std::pair<WrittenEnd, WrittenEnd>> parts;
  for (const std::string ending : kOsmpEndings) {
    parts.emplace_back(end_of({connection.from.instance, connection.from.variable + ending}),
                       end_of({connection.to.instance, connection.to.variable + ending}));
  }
  return parts;
}

void ConnectorWriter::write(pugi::xml_node component, std::size_t instance, DefinitionsWriter& definitions) const {
  if (connectors_[instance].empty()) return;
  auto connectors = component.append_child("ssd:Connectors");
  const auto& model = *system_->instances[instance].model;
  for (const auto& [name, known] : connectors_[instance]) {
    const auto& variable = *known.variable;
    auto connector = connectors.append_child("ssd:Connector");
    connector.append_attribute("name") = name.c_str();
    connector.append_attribute("kind") = kind_of_connector(variable.causality);
    const auto written = known.is_binary ? Type::binary : variable.type;
    auto type = connector.append_child(fmt::format("ssc:{}", modeldesc::to_string(written)).c_str());
    if (written == Type::enumeration) {
      definitions.add_enumeration(model, variable);
      type.append_attribute("name") = variable.declared_type.c_str();
    }
    const auto mime_type = known.is_binary && variable.osmp ? variable.osmp->mime_type : variable.fmi3->mime_type;
    if (written == Type::binary && !mime_type.empty()) type.append_attribute("mime-type") = mime_type.c_str();
    if (written == Type::clock) {
      const auto interval = static_cast<std::size_t>(variable.fmi3->timing->interval_variability);
      type.append_attribute("intervalVariability") =
          std::string(modeldesc::kIntervalVariabilityWords[interval]).c_str();
    }
    const auto unit = definitions.unit_of(model, variable);
    if (!unit.empty()) type.append_attribute("unit") = unit.c_str();
    write_dimensions(connector, known.sizes);
  }
}

}  // namespace mebots::master::ssp
