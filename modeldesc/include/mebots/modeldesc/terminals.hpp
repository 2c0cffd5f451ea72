// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace mebots::modeldesc {

/// A <Terminal> of terminalsAndIcons.xml (FMI 3.0 and 2.0.4): a set of variables that a tool connects together.
struct DeclaredTerminal {
  struct Member {
    std::string name;  ///< may be empty
    std::string variable;
  };
  std::string name;  ///< for a nested terminal, the names of both terminals, joined by a dot
  std::string kind;  ///< may be empty
  std::string matching_rule;
  std::string text;
  std::vector<Member> members;
};

/// Reads the text of a terminalsAndIcons.xml. `source` is the name of the text in messages. Throws mebots::Error if the
/// text is not XML.
std::vector<DeclaredTerminal> read_terminals(std::string_view text, std::string_view source);

}  // namespace mebots::modeldesc
