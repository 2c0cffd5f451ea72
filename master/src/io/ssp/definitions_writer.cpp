// SPDX-License-Identifier: Apache-2.0
#include "definitions_writer.hpp"

#include "connector_writer.hpp"
#include "mebots/input_error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <span>
#include <variant>
#include <vector>

namespace mebots::master::ssp {

std::string DefinitionsWriter::unit_of(const modeldesc::ModelDescription& model, const modeldesc::Variable& variable) {
  const auto* unit = model.unit(variable.unit);
  const bool is_float = variable.type == modeldesc::Type::real || variable.type == modeldesc::Type::float32;
  if (!is_float || unit == nullptr || !unit->has_base) return {};
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

using modeldesc::Type;
using modeldesc::Value;
using modeldesc::Variable;

/// Returns the text of a value; the name of the item for an enumeration.
std::string text_of(const modeldesc::ModelDescription& model, const Variable& variable, const Value& value) {
  const auto* number = std::get_if<std::int64_t>(&value);
  const auto* type = model.type_definition(variable.declared_type);
  if (number != nullptr && type != nullptr) {
    for (const auto& item : type->items) {
      if (item.value == *number) return item.name;
    }
  }
  return value_text(variable.type, value);
}

class ValuesWriter {
 public:
  ValuesWriter(const ResolvedInstance& instance, pugi::xml_node parameters, DefinitionsWriter& definitions)
      : instance_(instance), model_(*instance.model), parameters_(parameters), definitions_(definitions) {
    for (const auto& start : instance.starts) {
      values_.emplace(start.variable, start.value);
      if (const auto& element = start.variable->fmi3->element) arrays_.insert(element->array);
    }
  }

  void write() {
    for (const auto& variable : model_.variables) {
      const auto& element = variable.fmi3->element;
      if (variable.causality == modeldesc::Causality::structural_parameter) {
        const auto found = instance_.structural.find(variable.value_reference);
        if (found != instance_.structural.end()) add(variable, variable.name, fmt::format("{}", found->second));
      } else if (element && element->index == 0 && arrays_.contains(element->array)) {
        write_array(&variable, element->count);
      } else if (const auto found = values_.find(&variable); !element && found != values_.end()) {
        add(variable, variable.name, text_of(model_, variable, found->second));
      }
    }
  }

 private:
  pugi::xml_node add(const Variable& variable, const std::string& name, const std::optional<std::string>& text) {
    auto parameter = parameters_.append_child("ssv:Parameter");
    parameter.append_attribute("name") = name.c_str();
    auto type = parameter.append_child(fmt::format("ssv:{}", modeldesc::to_string(variable.type)).c_str());
    if (text) type.append_attribute("value") = text->c_str();
    if (variable.type == Type::binary && !variable.fmi3->mime_type.empty())
      type.append_attribute("mime-type") = variable.fmi3->mime_type.c_str();
    const auto unit = definitions_.unit_of(model_, variable);
    if (!unit.empty()) type.append_attribute("unit") = unit.c_str();
    if (variable.type == Type::enumeration) {
      type.append_attribute("name") = variable.declared_type.c_str();
      definitions_.add_enumeration(model_, variable);
    }
    return type;
  }

  /// Writes an array, whose elements are consecutive variables. Numbers become a list in one attribute, and each text
  /// becomes an element (SSP 2.0, 6.2).
  void write_array(const Variable* first, std::size_t count) {
    std::vector<std::string> texts;
    for (const auto& variable : std::span(first, count)) {
      const auto found = values_.find(&variable);
      const auto& value = found != values_.end() ? found->second : variable.start;
      if (std::holds_alternative<std::monostate>(value)) {
        throw InputError(
            ErrorCode::not_offered,
            fmt::format("instance '{}': SSP sets an array as a whole, and neither the config nor the FMU has a value "
                        "for '{}'. Give a value to each element of '{}'",
                        instance_.description->name, variable.name, first->fmi3->element->array));
      }
      texts.push_back(text_of(model_, variable, value));
    }
    const bool has_elements =
        first->type == Type::string || first->type == Type::binary || first->type == Type::enumeration;
    const auto list = has_elements ? std::nullopt : std::optional(fmt::format("{}", fmt::join(texts, " ")));
    auto type = add(*first, first->fmi3->element->array, list);
    if (has_elements) {
      for (const auto& text : texts) type.append_child("ssv:Value").append_attribute("value") = text.c_str();
    }
    write_dimensions(type.parent(), indices_of(*(first + count - 1)));
  }

  const ResolvedInstance& instance_;
  const modeldesc::ModelDescription& model_;
  pugi::xml_node parameters_;
  DefinitionsWriter& definitions_;
  std::map<const Variable*, Value> values_;
  std::set<std::string> arrays_;  // names of all arrays that have a value
};

}  // namespace

const char* written_version(const ResolvedSystem& system) {
  const auto is_fmi3 = [](const ResolvedInstance& instance) { return instance.model->is_fmi3(); };
  return std::ranges::any_of(system.instances, is_fmi3) ? "2.0" : "1.0";
}

void write_parameter_set(const ResolvedInstance& instance, const char* version, pugi::xml_document& document) {
  auto set = document.append_child("ssv:ParameterSet");
  set.append_attribute("xmlns:ssv") = "http://ssp-standard.org/SSP1/SystemStructureParameterValues";
  set.append_attribute("xmlns:ssc") = "http://ssp-standard.org/SSP1/SystemStructureCommon";
  set.append_attribute("version") = version;
  set.append_attribute("name") = "initialValues";  // Ecos and Vico use the parameter set with this name
  DefinitionsWriter definitions;
  ValuesWriter(instance, set.append_child("ssv:Parameters"), definitions).write();
  definitions.write(set, "ssv:");
}

}  // namespace mebots::master::ssp
