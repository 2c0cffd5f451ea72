// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "description.hpp"
#include "mebots/data/node.hpp"

#include <map>
#include <string>
#include <string_view>
#include <vector>

/// Reads the keys of description.json that select versions of FMI, or that only FMI 3.0 uses.
namespace mebots::modeldesc {

/// Throws Mistakes with the place of `node` if XML cannot represent the text.
void check_xml_text(const data::Node& node, std::string_view text);
std::string xml_text(const data::Node& node);

template <typename T>
std::vector<std::string> names_of(const std::vector<T>& list) {
  std::vector<std::string> names;
  for (const auto& element : list) names.push_back(element.name);
  return names;
}

/// Reads the key `fmi`, whose value is 2, 3 or a list of both. The result is in ascending order.
std::vector<FmiVersion> read_fmi_versions(const data::Node& node);

/// Reads the key `arrays` and marks groups as arrays. The result contains, for a group with a size parameter, the node
/// with the parameter's name.
std::map<std::string, data::Node> read_arrays(const data::Node& node, std::vector<Group>& groups);

/// Adds a mistake if the size parameter of an array does not exist, or may exceed the number of the group's words.
void check_size_source(const data::Node& node, std::string_view group, const Description& description);

/// Reads the key `terminals` of a description or of a board's device. If the name of an entry contains {group}, the
/// entry declares one terminal per word of the group.
void read_terminals(const data::Node& node, Description& description);

}  // namespace mebots::modeldesc
