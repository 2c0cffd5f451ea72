// SPDX-License-Identifier: Apache-2.0
#include "fmi3_variables.hpp"

#include "mebots/error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

namespace mebots::modeldesc {
namespace {

/// Returns the common stem of a group's words, such as "rotor" for "rotor[1]" and "rotor[2]". If the words have no such
/// form, returns an empty text.
std::string common_stem(const Group& group) {
  const std::string stem = group.words.front().substr(0, group.words.front().rfind('['));
  const auto has_stem = [&](const std::string& word) {
    return word.ends_with(']') && word.substr(0, word.rfind('[')) == stem;
  };
  return std::ranges::all_of(group.words, has_stem) ? stem : "";
}

/// Returns the name of the array for a field whose name contains {group}. Replaces {group} by the common stem of the
/// group's words, such as "rotor" for "rotor[1]" and "rotor[2]". If the words have no common stem, removes {group}:
/// drone.position.{axis} becomes drone.position. If such a name starts with {group}, replaces {group} by the group's
/// name.
std::string array_name(const Field& field, const Group& group) {
  std::string name = field.name;
  const auto open = name.find('{');
  const std::string stem = common_stem(group);
  const std::string word = stem.empty() && open == 0 ? group.name : stem;
  name.replace(open, group.name.size() + 2, word);
  if (!word.empty()) return name;
  if (const auto dots = name.find(".."); dots != std::string::npos) name.erase(dots, 1);
  if (name.ends_with('.')) name.pop_back();
  return name;
}

/// Returns the name of the FMI 3.0 array that contains a variable of all copies, such as drone.rotor.thrust for
/// rotor.thrust.
std::string name_over_copies(const Repeat& repeat, const std::string& name) {
  return name.starts_with(repeat.word + '.') ? name : repeat.word + '.' + name;
}

std::string array_text(const Field& field, const Group& group) {
  return common_stem(group).empty() ? fmt::format("{} ({})", field.text, fmt::join(group.words, ", ")) : field.text;
}

/// Throws Error if the group of a field with copies is not an array of fixed size. The copies of the field form one
/// array in FMI 3.0, in which the elements of one copy must be adjacent.
void check_repeated_group(const Description& description, const Field& field, const Group* group) {
  if (group == nullptr || (group->is_array && group->size_source.empty())) return;
  throw Error(ErrorCode::invalid_value,
              fmt::format("{}: in FMI 3.0, the copies of {} form an array; add \"{}\": true to 'arrays'",
                          description.source, field.name, group->name));
}

/// Returns the name of the parameter that contains the array's size; empty if the size is fixed.
std::string size_source_of(const Description& description, const Fmi3Variable& variable) {
  if (variable.copies > 1) return description.repeat->size_source;
  return variable.is_array ? description.groups[*variable.field->group].size_source : "";
}

void check_names(const Description& description, const std::vector<Fmi3Variable>& variables) {
  std::set<std::string_view> names = {kTimeName};
  for (const Fmi3Variable& variable : variables) {
    if (names.insert(variable.name).second) continue;
    throw Error(
        ErrorCode::duplicate_name,
        fmt::format(
            "{}: in FMI 3.0, {} would have the name {}, which is {}; rename it, or remove its group from 'arrays'",
            description.source, variable.field->name, variable.name,
            variable.name == kTimeName ? "that of the independent variable" : "taken"));
  }
}

}  // namespace

std::size_t rows_per_element(const Field& field) {
  return field.type == FieldType::binary ? kOsmpRoles.size() : 1;
}

std::vector<Fmi3Variable> fmi3_variables(const Description& description) {
  std::vector<Fmi3Variable> variables;
  std::size_t row = 0;
  for (const Field& field : description.fields) {
    const Group* group = field.group ? &description.groups[*field.group] : nullptr;
    const bool has_copies = description.has_copies(field);
    const bool over_words = group != nullptr && group->is_array;
    if (has_copies) check_repeated_group(description, field, group);
    const bool is_array = over_words || has_copies;
    const std::size_t count = is_array && !field.fmi_names.empty() ? 1 : field.fmi_names.size();
    for (std::size_t i = 0; i < count; ++i) {
      Fmi3Variable variable;
      variable.field = &field;
      variable.name = over_words ? array_name(field, *group) : has_copies ? field.name : field.fmi_names[i];
      if (has_copies) variable.name = name_over_copies(*description.repeat, variable.name);
      variable.text = over_words ? array_text(field, *group) : field.text;
      variable.value_reference = static_cast<std::uint32_t>(row);
      variable.first = i;
      variable.copies = has_copies ? description.repeat->count : 1;
      variable.words = over_words ? field.words : 1;
      variable.elements = variable.copies * variable.words;
      variable.start_elements = variable.elements;
      variable.rows = variable.elements * rows_per_element(field);
      variable.is_array = is_array;
      row += variable.rows;
      variables.push_back(std::move(variable));
    }
  }
  for (Fmi3Variable& variable : variables) {
    const std::string size_source = size_source_of(description, variable);
    if (size_source.empty()) continue;
    const auto source = std::ranges::find(variables, size_source, [](const Fmi3Variable& v) { return v.field->name; });
    source->is_structural = true;
    variable.size_reference = source->value_reference;
    const auto size = static_cast<std::size_t>(whole_number_of(source->field->starts.front()));
    variable.start_elements = variable.copies > 1 ? size * variable.words : size;
  }
  check_names(description, variables);
  return variables;
}

const char* fmi3_type(const Fmi3Variable& variable) {
  switch (variable.field->type) {
    case FieldType::real:
      return "Float64";
    case FieldType::integer:
      return variable.is_structural ? "UInt64" : "Int32";
    case FieldType::boolean:
      return "Boolean";
    case FieldType::string:
      return "String";
    case FieldType::binary:
      return "Binary";
    case FieldType::enumeration:
      return "Enumeration";
  }
  return "";
}

}  // namespace mebots::modeldesc
