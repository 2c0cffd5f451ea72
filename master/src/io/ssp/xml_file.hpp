// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pugixml.hpp>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::master::ssp {

/// One XML file of an SSP. Elements are found by local name, whatever prefix the writer chose.
class XmlFile {
 public:
  /// `name` names the file in messages. Throws InputError with the line of what is not well-formed.
  XmlFile(std::string_view bytes, std::string name);
  XmlFile(const XmlFile&) = delete;
  XmlFile& operator=(const XmlFile&) = delete;

  const std::string& name() const { return name_; }
  pugi::xml_node root() const { return document_.document_element(); }
  /// "SystemStructure.ssd, line 12"
  std::string place(pugi::xml_node node) const;
  [[noreturn]] void fail(pugi::xml_node node, const std::string& what) const;

  std::string required(pugi::xml_node node, const char* attribute) const;
  double number(pugi::xml_node node, const char* attribute, double fallback) const;
  bool flag(pugi::xml_node node, const char* attribute, bool fallback) const;

 private:
  std::string text_;
  std::string name_;
  pugi::xml_document document_;
};

/// Name without prefix.
std::string_view local_name(pugi::xml_node node);
/// First child of this local name, or a null node.
pugi::xml_node child(pugi::xml_node node, std::string_view name);
std::vector<pugi::xml_node> children(pugi::xml_node node, std::string_view name);

/// The whole text as a finite number, or nothing.
std::optional<double> parse_number(std::string_view text);

}  // namespace mebots::master::ssp
