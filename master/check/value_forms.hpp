// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace mebots::check {

/// What the value of an XML attribute has to look like.
struct Form {
  std::string_view name;  // `number`, `flag`: as the rules of the schema call it
  bool (*holds)(std::string_view value);
  std::string expected;  // for people: "a whole number of 32 bits"
};

/// The form of this name. Throws mebots::Error where there is none.
const Form& find_form(std::string_view name);

/// Without white space at its ends.
std::string_view trimmed(std::string_view text);

}  // namespace mebots::check
