// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "value_forms.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

/// The grammar of modelDescription.xml: what each element may hold.
namespace mebots::check {

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

/// What one element may hold; children stand in the order given.
struct ElementRule {
  std::vector<AttributeRule> attributes;
  std::vector<ChildRule> children;
  bool alternatives = false;  // exactly one of `children` but for Annotations
  bool anything = false;      // a vendor's own contents
};

/// The rule of the root element, fmiModelDescription, and through its children all others.
const ElementRule& schema_rules();

}  // namespace mebots::check
