// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// The grammar of modelDescription.xml.
namespace mebots::check {

/// The required form of an XML attribute's value.
struct Form {
  std::string_view name;  // its name in the rules of the schema, such as `number`, `flag`
  bool (*holds)(std::string_view value);
  std::string expected;  // for people: "a whole number of 32 bits"
};

/// Returns the form of this name. Throws mebots::Error for an unknown name.
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

/// Attributes and children of one element. Children must be in this order.
struct ElementRule {
  std::vector<AttributeRule> attributes;
  std::vector<ChildRule> children;
  bool alternatives = false;  // exactly one of `children` but for Annotations
  bool anything = false;      // a vendor's own contents
};

/// Returns the rule of the root element, fmiModelDescription. All other rules are its children.
const ElementRule& schema_rules();

}  // namespace mebots::check
