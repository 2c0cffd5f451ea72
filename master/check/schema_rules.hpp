// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Declares the grammar of modelDescription.xml.
namespace mebots::check {

/// The required form of an XML attribute's value.
struct Form {
  std::string_view name;  // the name that rules use, such as `number` or `flag`
  bool (*holds)(std::string_view value);
  std::string expected;  // a description for messages, such as "a whole number of 32 bits"
};

/// Returns the form that has this name in rules. Throws mebots::Error if no form has this name.
const Form& find_form(std::string_view name);

/// Returns the text without white space at both ends.
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

/// The attributes and children of an XML element. Children must be in the order of `children`, unless `unordered` is
/// true.
struct ElementRule {
  std::vector<AttributeRule> attributes;
  std::vector<ChildRule> children;
  // true: exactly one of `children` is required, in addition to Annotations and DirectDependency
  bool alternatives = false;
  bool unordered = false;  // true: at least one of `children` is required, in any order
  bool anything = false;   // true: the vendor defines the contents
};

/// A row of a grammar, written as text. Attributes are written as `name` or `name:form`, followed by `!` if required.
/// Children are written as names of elements, or as `name=rule` if the rule of an element depends on its parent. A
/// child occurs exactly once, unless followed by `?` (at most once), `+` (at least once) or `*` (any number). `|`
/// before the children permits exactly one of them; `&` requires at least one, in any order.
struct RuleRow {
  std::string_view rule;
  std::string_view attributes;
  std::string_view children;
};

/// These functions return the grammars of FMI 1.0 for co-simulation and of FMI 3.0.
std::span<const RuleRow> fmi1_rule_rows();
std::span<const RuleRow> fmi3_rule_rows();

/// The grammar of one FMI version.
struct Grammar {
  std::string_view version;  // shown in messages, such as "3.0"
  const ElementRule* root;   // fmiModelDescription, or fmiTerminalsAndIcons
  bool foreign_attributes;   // true if attributes of other name spaces are permitted
};

/// Returns the grammar of modelDescription.xml for an FMI version. All versions 3.x have the grammar of 3.0. Versions
/// other than 1.0 and 3.x have the grammar of 2.0.
Grammar grammar_of(std::string_view fmi_version);
Grammar grammar_of_terminals();

}  // namespace mebots::check
