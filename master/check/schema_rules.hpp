// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::check {

struct Form {
  std::string_view name;  // name in rules, such as `number` or `flag`
  bool (*holds)(std::string_view value);
  std::string expected;  // description in messages, such as "a whole number of 32 bits"
};

/// Returns the form with this name. Throws Error if the name is unknown.
const Form& find_form(std::string_view name);

/// Removes white space at both ends.
std::string_view trimmed(std::string_view text);

struct AttributeRule {
  std::string name;
  const Form* form;
  bool required;
};

struct ElementRule;

struct ChildRule {
  std::string name;
  const ElementRule* element;
  std::size_t least;
  std::size_t most;  // SIZE_MAX: any number
};

/// The attributes and children of an XML element. Children must be in the order of `children` unless `unordered` is
/// true.
struct ElementRule {
  std::vector<AttributeRule> attributes;
  std::vector<ChildRule> children;
  // exactly one of `children` is required, in addition to Annotations and DirectDependency
  bool alternatives = false;
  bool unordered = false;  // at least one of `children` is required, in any order
  bool anything = false;   // the vendor defines the contents
};

/// Describes an XML element of a grammar as text. `attributes` are names, or `name:form` if find_form(form) checks the
/// value, with `!` if required. `children` are the names of elements, or `name=rule` if the child's rule depends on
/// this parent. A child occurs once; `?` means at most once, `+` at least once, `*` any number. A `|` before the
/// children requires exactly one of them, `&` at least one in any order.
struct RuleRow {
  std::string_view rule;
  std::string_view attributes;
  std::string_view children;
};

/// Return the grammars of FMI 1.0 co-simulation and FMI 3.0.
std::span<const RuleRow> fmi1_rule_rows();
std::span<const RuleRow> fmi3_rule_rows();

struct Grammar {
  std::string_view version;  // for messages, such as "3.0"
  const ElementRule* root;   // rule of fmiModelDescription or fmiTerminalsAndIcons
  bool foreign_attributes;   // permits attributes with a namespace prefix
};

/// Returns the grammar of modelDescription.xml for an FMI version: 1.0, 3.0 for all versions 3.x, and 2.0 for all other
/// versions.
Grammar grammar_of(std::string_view fmi_version);
Grammar grammar_of_terminals();

}  // namespace mebots::check
