// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "description.hpp"
#include "mebots/data/node.hpp"

#include <map>
#include <string>
#include <string_view>
#include <vector>

/// Keys of description.json that concern versions of FMI, and those that only FMI 3.0 has a use for.
namespace mebots::modeldesc {

/// Throws Mistakes if a modelDescription.xml could not hold the text.
void check_xml_text(const data::Node& node, std::string_view text);
std::string xml_text(const data::Node& node);

template <typename T>
std::vector<std::string> names_of(const std::vector<T>& list) {
  std::vector<std::string> names;
  for (const auto& element : list) names.push_back(element.name);
  return names;
}

/// `fmi`: 2, 3 or a list of both; returned in rising order.
std::vector<FmiVersion> read_fmi_versions(const data::Node& node);

/// `arrays`: marks groups as arrays. Returns where those with a parameter of their size name it, by group.
std::map<std::string, data::Node> read_arrays(const data::Node& node, std::vector<Group>& groups);

/// Notes if the parameter of an array's size is none, or could ask for more elements than the group has words.
void check_size_source(const data::Node& node, std::string_view group, const Description& description);

/// `terminals`, of a description or of a board's device. A name with a {group} stands for one terminal per word.
void read_terminals(const data::Node& node, Description& description);

}  // namespace mebots::modeldesc
