// SPDX-License-Identifier: Apache-2.0
#include "copies.hpp"
#include "generate.hpp"

#include "mebots/modeldesc/xml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

namespace mebots::modeldesc {
namespace {

/// Returns the log categories that the FMI standard recommends. Every FMU has these in addition to its own.
const std::vector<LogCategory>& standard_log_categories() {
  static const std::vector<LogCategory> categories = {
      {"logStatusWarning", "Warnings"},
      {"logStatusError", "Errors; they are always logged"},
      {"logStatusFatal", "Errors after which the instance cannot be used; they are always logged"},
      {"logAll", "Everything"},
  };
  return categories;
}

Type type_of(FieldType type) {
  switch (type) {
    case FieldType::real:
      return Type::real;
    case FieldType::integer:
      return Type::integer;
    case FieldType::boolean:
      return Type::boolean;
    case FieldType::string:
      return Type::string;
    case FieldType::binary:
      return Type::integer;
    case FieldType::enumeration:
      return Type::enumeration;
  }
  return Type::real;
}

void add_variables(const Field& field, ModelDescription& result) {
  for (std::size_t i = 0; i < field.fmi_names.size(); ++i) {
    Variable variable;
    variable.name = field.fmi_names[i];
    variable.type = type_of(field.type);
    variable.causality = field.causality;
    variable.variability = field.variability;
    if (field.causality == Causality::parameter) variable.initial = Initial::exact;
    if (field.causality == Causality::output) variable.initial = Initial::calculated;
    if (!field.starts.empty()) variable.start = field.starts[i % field.words];
    variable.declared_type = field.enumeration;
    variable.unit = field.unit;
    variable.min = field.min;
    variable.max = field.max;
    variable.nominal = field.nominal;
    variable.text = field.text;
    const auto add = [&](Variable v) {
      v.value_reference = static_cast<std::uint32_t>(result.variables.size());
      result.variables.push_back(std::move(v));
    };
    if (field.type != FieldType::binary) {
      add(std::move(variable));
      continue;
    }
    for (const std::string_view role : kOsmpRoles) {
      Variable part = variable;
      part.name = fmt::format("{}.{}", variable.name, role);
      part.osmp = OsmpPart{variable.name, std::string(role), field.mime_type};
      if (field.causality == Causality::input) part.start = std::int64_t{0};
      add(std::move(part));
    }
  }
}

void add_structure(const Description& description, ModelDescription& result) {
  std::map<std::string, std::vector<std::size_t>> by_name;
  std::vector<std::size_t> parameters;
  for (std::size_t i = 0; i < result.variables.size(); ++i) {
    const Variable& variable = result.variables[i];
    by_name[variable.osmp ? variable.osmp->name : variable.name].push_back(i);
    if (variable.causality == Causality::parameter) parameters.push_back(i);
  }
  const bool has_copies = description.repeat && description.repeat->count > 1;
  static const std::vector<std::size_t> kAbsent;  // of an input that an FMU of one copy does not have
  const auto indices_of = [&](const std::string& name, std::size_t copy) -> const std::vector<std::size_t>& {
    const auto copied = has_copies ? by_name.find(name_in_copy(description, name, copy)) : by_name.end();
    if (copied != by_name.end()) return copied->second;
    const auto shared = by_name.find(name);
    return shared == by_name.end() ? kAbsent : shared->second;
  };
  const auto with_indices = [&](std::vector<std::size_t> indices, const std::vector<std::string>& names,
                                std::size_t copy) {
    for (const std::string& name : names) {
      const auto& more = indices_of(name, copy);
      indices.insert(indices.end(), more.begin(), more.end());
    }
    std::ranges::sort(indices);
    return indices;
  };
  for (const Field& field : description.fields) {
    if (field.causality != Causality::output) continue;
    for (std::size_t i = 0; i < field.fmi_names.size(); ++i) {
      const std::size_t copy = i / field.words;
      const auto dependencies = with_indices({}, field.depends_on, copy);
      // The initial value of an output may depend on every parameter, because the model is created from all parameters.
      // It may depend on every input unless the description excludes it.
      std::optional<std::vector<std::size_t>> first;
      if (field.first_depends_on) first = with_indices(parameters, *field.first_depends_on, copy);
      for (const std::size_t index : by_name.at(field.fmi_names[i])) {
        result.outputs.push_back({index, dependencies, {}});
        result.initial_unknowns.push_back({index, first, {}});
      }
    }
  }
}

}  // namespace

ModelDescription to_model_description(const Description& description, std::vector<std::string> source_files) {
  ModelDescription result;
  result.fmi_version = "2.0";
  result.model_name = description.name;
  result.text = description.text;
  result.author = "The MEbots authors";
  result.version = MEBOTS_VERSION;
  result.copyright = "The MEbots authors";
  result.license = "Apache-2.0";
  result.generation_tool = "MEbots " MEBOTS_VERSION;
  result.structured_names = true;
  CoSimulation& flags = result.co_simulation.emplace();
  flags.model_identifier = description.name;
  flags.can_handle_variable_communication_step_size = true;
  flags.can_get_and_set_fmu_state = true;
  flags.can_serialize_fmu_state = true;
  flags.can_not_use_memory_management_functions = true;
  flags.source_files = std::move(source_files);

  for (const Enumeration& enumeration : description.enumerations) {
    TypeDefinition& type = result.types.emplace_back();
    type.name = enumeration.name;
    type.type = Type::enumeration;
    type.items = enumeration.items;
  }
  result.log_categories = description.log_categories;
  const auto& standard = standard_log_categories();
  result.log_categories.insert(result.log_categories.end(), standard.begin(), standard.end());
  result.default_experiment = {0.0, description.stop_time_s, std::nullopt, description.step_s};

  std::set<std::string> used_units;
  for (const Field& field : description.fields) {
    add_variables(field, result);
    if (!field.fmi_names.empty()) used_units.insert(field.unit);
  }
  for (const std::string& unit : used_units)
    if (!unit.empty()) result.units.push_back(parse_unit(unit));
  add_structure(description, result);
  result.guid = token_of(write_xml(result));
  return result;
}

}  // namespace mebots::modeldesc
