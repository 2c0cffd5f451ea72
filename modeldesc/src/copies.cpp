// SPDX-License-Identifier: Apache-2.0
#include "copies.hpp"

#include "fmi3_keys.hpp"
#include "generate.hpp"
#include "mebots/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

namespace mebots::modeldesc {
namespace {

using data::Node;

enum class Copies { each, shared, shared_by_many };

/// Returns the name of a variable in a copy: `drone[2].mass` for drone.mass, and `drone[2].rotor[1].thrust` for
/// rotor[1].thrust. `copy` starts at 0.
std::string copied_name(const std::string& word, const std::string& name, std::size_t copy) {
  const bool has_word = name.starts_with(word + '.');
  return fmt::format("{}[{}].{}", word, copy + 1, has_word ? name.substr(word.size() + 1) : name);
}

void check_unique(const Description& description) {
  std::set<std::string_view> names;
  for (const Field& field : description.fields) {
    for (const std::string& name : field.fmi_names) {
      if (names.insert(name).second) continue;
      throw Error(ErrorCode::duplicate_name,
                  fmt::format("{}: with {} copies, two variables have the name {}; rename one of them",
                              description.source, description.repeat->count, name));
    }
  }
}

}  // namespace

Node read_repeat(const Node& node, Description& description) {
  const auto members = node.members();
  if (members.size() != 1)
    node.fail(ErrorCode::invalid_value, "name one object to repeat, such as {\"drone\": \"drone.count\"}");
  const auto& [word, size] = members.front();
  if (!is_cpp_identifier(word)) size.fail(ErrorCode::invalid_value, fmt::format("\"{}\" is not a C++ name", word));
  description.repeat = Repeat{word, size.text(), 1};
  return size;
}

void read_copies(data::Object& object, Field& field, const Description& description) {
  static const auto words = data::word_of<Copies>(
      {{"each", Copies::each}, {"shared", Copies::shared}, {"shared_by_many", Copies::shared_by_many}});
  if (!description.repeat) {
    for (const char* key : {"copies", "start_of_many"}) {
      if (const auto member = object.node().find(key))
        member->complain(ErrorCode::invalid_value, "this needs the key 'repeat' of the description");
    }
    return;
  }
  Copies copies = Copies::each;
  object.read_if("copies", copies, words);
  field.is_shared = copies != Copies::each;
  field.only_if_many = copies == Copies::shared_by_many;
  if (!field.other_starts.empty() && (copies != Copies::shared || field.group)) {
    object.node()
        .at("start_of_many")
        .complain(ErrorCode::invalid_value, "this is for a variable without a group and with \"copies\": \"shared\"");
  }
}

void check_repeat(const Node& node, const Description& description) {
  node.attempt([&] {
    const std::string& name = description.repeat->size_source;
    const auto field = std::ranges::find(description.fields, name, &Field::name);
    if (field == description.fields.end()) node.fail_unknown("the parameter", name, names_of(description.fields));
    const bool is_parameter = field->type == FieldType::integer && field->causality == Causality::parameter &&
                              field->variability == Variability::fixed && !field->group;
    if (is_parameter && field->only_if_many && field->min.value_or(0) >= 1) return;
    node.fail(ErrorCode::invalid_value,
              fmt::format("{} must be a fixed Integer parameter with \"copies\": \"shared_by_many\" and a min of at "
                          "least 1",
                          name));
  });
}

void make_copies(Description& description, std::size_t count) {
  if (!description.repeat) {
    if (count == 1) return;
    throw Error(ErrorCode::invalid_value,
                fmt::format("{}: {} copies, but the description repeats nothing; add the key 'repeat'",
                            description.source, count));
  }
  Repeat& repeat = *description.repeat;
  const bool was_many = std::exchange(repeat.count, count) > 1;
  for (Field& field : description.fields) {
    if (field.only_if_many && count == 1) field.fmi_names.clear();
    if (was_many != (count > 1) && !field.other_starts.empty()) std::swap(field.starts, field.other_starts);
    if (field.name == repeat.size_source) {
      field.starts = {static_cast<std::int64_t>(count)};
      field.max = static_cast<double>(count);
    }
    if (!description.has_copies(field)) continue;
    const auto names = std::exchange(field.fmi_names, {});
    for (std::size_t copy = 0; copy < count; ++copy)
      for (const std::string& name : names) field.fmi_names.push_back(copied_name(repeat.word, name, copy));
  }
  check_unique(description);
}

std::string name_in_copy(const Description& description, const std::string& name, std::size_t copy) {
  return copied_name(description.repeat->word, name, copy);
}

}  // namespace mebots::modeldesc
