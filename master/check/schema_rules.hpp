// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// The grammar of modelDescription.xml.
namespace mebots::check {

/// The required form of an XML attribute's value.
struct Form {
  std::string_view name;  // its name in the rules, such as `number`, `flag`
  bool (*holds)(std::string_view value);
  std::string expected;  // readable: "a whole number of 32 bits"
};

/// Returns the form with this name. Throws mebots::Error for an unknown name.
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

/// The attributes and children of one element. Children must be in the order of `children`, unless `unordered` is true.
struct ElementRule {
  std::vector<AttributeRule> attributes;
  std::vector<ChildRule> children;
  bool alternatives = false;  // exactly one of `children`, not counting Annotations and DirectDependency
  bool unordered = false;     // at least one of `children`, in any order
  bool anything = false;      // contents are up to the vendor
};

/// A row of a grammar as text. Attributes are `name` or `name:form`, with `!` if required. Children are names of
/// elements, or `name=rule` if an element's rule depends on its place; `?` means at most once, `+` at least once, `*`
/// any number, otherwise exactly once. `|` before the children means exactly one of them; `&` means at least one, in
/// any order.
struct RuleRow {
  std::string_view rule;
  std::string_view attributes;
  std::string_view children;
};

/// These functions return the grammars of FMI 1.0 for co-simulation and of FMI 3.0.
std::span<const RuleRow> fmi1_rule_rows();
std::span<const RuleRow> fmi3_rule_rows();

/// The grammar of a version of FMI.
struct Grammar {
  std::string_view version;  // readable, "3.0"
  const ElementRule* root;   // fmiModelDescription, or fmiTerminalsAndIcons
  bool foreign_attributes;   // permits attributes of other name spaces
};

/// Returns the grammar of modelDescription.xml for a version: that of 1.0, of 3.0 for all versions 3.x, or of 2.0 for
/// all others.
Grammar grammar_of(std::string_view fmi_version);
Grammar grammar_of_terminals();

}  // namespace mebots::check
