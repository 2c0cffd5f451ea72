// SPDX-License-Identifier: Apache-2.0
#include "fmi3_keys.hpp"

#include "mebots/data/object.hpp"
#include "mebots/error.hpp"
#include "mebots/modeldesc/xml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

namespace mebots::modeldesc {
namespace {

using data::Node;
using data::Object;

std::string with_word(std::string_view name, const Group& group, std::string_view word) {
  std::string result(name);
  const std::string mark = "{" + group.name + "}";
  if (const auto at = result.find(mark); at != std::string::npos) result.replace(at, mark.size(), word);
  return result;
}

/// Returns the group whose name is in braces in a terminal's name. Returns null if the name contains no braces.
const Group* group_in(const Node& node, std::string_view name, const std::vector<Group>& groups) {
  const auto open = name.find('{');
  if (open == std::string_view::npos) return nullptr;
  const auto close = name.find('}', open);
  const auto word = name.substr(open + 1, close == std::string_view::npos ? close : close - open - 1);
  const auto found = std::ranges::find(groups, word, &Group::name);
  if (found == groups.end()) node.fail_unknown("the group", word, names_of(groups));
  return &*found;
}

class TerminalReader {
 public:
  explicit TerminalReader(Description& description) : description_(description) {}

  void read(const std::string& name, const Node& node) {
    const Group* group = group_in(node, name, description_.groups);
    Object object(node);
    Terminal terminal;
    object.read_if("text", terminal.text, &xml_text);
    object.read("kind", terminal.kind, &xml_text);
    object.read_if("matching_rule", terminal.matching_rule,
                   data::word_of<std::string>({{"plug", "plug"}, {"bus", "bus"}}));
    object.allow({"members"});
    object.finish();
    const std::size_t count = group == nullptr ? 1 : group->words.size();
    for (std::size_t i = 0; i < count; ++i) {
      terminal.name = group == nullptr ? name : with_word(name, *group, group->words[i]);
      terminal.members = read_members(node.at("members"), group, i);
      if (std::ranges::find(description_.terminals, terminal.name, &Terminal::name) != description_.terminals.end())
        node.fail(ErrorCode::duplicate_name, fmt::format("the terminal {} already exists", terminal.name));
      description_.terminals.push_back(terminal);
      if (node.noted() != 0) return;  // avoids the same mistakes for the other words
    }
  }

 private:
  std::vector<Terminal::Member> read_members(const Node& node, const Group* group, std::size_t word) const {
    std::vector<Terminal::Member> members;
    for (const auto& [name, variable] : node.members()) {
      variable.attempt([&, &name = name, &variable = variable] {
        check_xml_text(variable, name);
        members.push_back(member(name, variable, group, word));
      });
    }
    if (node.members().empty()) node.fail(ErrorCode::invalid_value, "a terminal needs at least one member");
    return members;
  }

  /// Finds the variable of a terminal's member. The member contains a name from `variables`, or the FMI name of one
  /// variable of a group.
  Terminal::Member member(const std::string& name, const Node& node, const Group* group, std::size_t word) const {
    const std::string variable = node.text();
    std::vector<std::string> known;
    for (std::size_t i = 0; i < description_.fields.size(); ++i) {
      const Field& field = description_.fields[i];
      const Group* own = field.group ? &description_.groups[*field.group] : nullptr;
      if (field.name == variable) {
        if (own == nullptr || own->is_array) return {name, i, 0};
        if (own == group) return {name, i, word};
      } else if (own != nullptr && !own->is_array) {
        const auto found = std::ranges::find(field.fmi_names, variable);
        if (found != field.fmi_names.end()) return {name, i, static_cast<std::size_t>(found - field.fmi_names.begin())};
        known.insert(known.end(), field.fmi_names.begin(), field.fmi_names.end());
      }
      known.push_back(field.name);
    }
    if (std::ranges::find(known, variable) != known.end())
      node.fail(ErrorCode::invalid_value,
                fmt::format("{} stands for several variables; name one of them, make its group an array, or put the "
                            "group into the terminal's name",
                            variable));
    node.fail_unknown("the variable", variable, known);
  }

  Description& description_;
};

}  // namespace

void check_xml_text(const Node& node, std::string_view text) {
  if (const auto found = first_no_xml_character(text)) {
    node.fail(ErrorCode::invalid_value,
              fmt::format("this contains the character \\u{:04x}, which XML does not allow; remove it", *found));
  }
}

std::string xml_text(const Node& node) {
  auto text = node.text();
  check_xml_text(node, text);
  return text;
}

std::vector<FmiVersion> read_fmi_versions(const Node& node) {
  const auto version = [](const Node& number) {
    return static_cast<FmiVersion>(
        number.whole_number(static_cast<int>(FmiVersion::two), static_cast<int>(FmiVersion::three)));
  };
  if (!node.is(data::Kind::list)) return {version(node)};
  auto versions = data::list_of(version)(node);
  if (versions.empty()) node.fail(ErrorCode::invalid_value, "the list is empty; it needs 2, 3 or both");
  std::ranges::sort(versions);
  versions.erase(std::unique(versions.begin(), versions.end()), versions.end());
  return versions;
}

std::map<std::string, Node> read_arrays(const Node& node, std::vector<Group>& groups) {
  std::map<std::string, Node> size_sources;
  for (const auto& [name, size] : node.members()) {
    size.attempt([&, &name = name, &size = size] {
      const auto group = std::ranges::find(groups, name, &Group::name);
      if (group == groups.end()) size.fail_unknown("the group", name, names_of(groups));
      group->is_array = true;
      if (size.is(data::Kind::text)) {
        group->size_source = size.text();
        size_sources.emplace(name, size);
      } else if (!size.flag()) {
        size.fail(ErrorCode::invalid_value,
                  "this must be true, or the name of the Integer parameter with the number of elements");
      }
    });
  }
  return size_sources;
}

void check_size_source(const Node& node, std::string_view group_name, const Description& description) {
  node.attempt([&] {
    const Group& group = *std::ranges::find(description.groups, group_name, &Group::name);
    const auto field = std::ranges::find(description.fields, group.size_source, &Field::name);
    if (field == description.fields.end())
      node.fail_unknown("the parameter", group.size_source, names_of(description.fields));
    const auto most = static_cast<double>(group.words.size());
    const bool is_parameter = field->type == FieldType::integer && field->causality == Causality::parameter &&
                              field->variability == Variability::fixed && !field->group;
    const bool is_bound = field->min.value_or(-1) >= 0 && field->max.value_or(most + 1) <= most;
    if (is_parameter && is_bound && whole_number_of(field->starts.front()) >= 1) return;
    node.fail(ErrorCode::invalid_value,
              fmt::format("{} must be a fixed Integer parameter with a min of at least 0, a max of at most {} (the "
                          "words of the group {}) and a start of at least 1",
                          group.size_source, most, group.name));
  });
}

void read_terminals(const Node& node, Description& description) {
  node.attempt([&] {
    TerminalReader reader(description);
    for (const auto& [name, terminal] : node.members()) {
      terminal.attempt([&, &name = name, &terminal = terminal] {
        check_xml_text(terminal, name);
        reader.read(name, terminal);
      });
    }
  });
}

}  // namespace mebots::modeldesc
