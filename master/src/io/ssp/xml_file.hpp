// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "files.hpp"
#include "model.hpp"

#include <pugixml.hpp>

#include <memory>
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

/// Elements that SSD, SSV and SSM share (SSP 2.0, chapter 4).
namespace mebots::master::ssp {

/// The surroundings of a file in an SSP.
struct Source {
  const Files& files;
  std::string archive;         ///< what the SSP is called
  std::filesystem::path base;  ///< folder of the SSD: relative URIs begin there
  std::vector<std::string>& notices;
};

/// The file that a URI names, by its path in `source.files`. Throws InputError for a URI that is no file's, leaves a
/// closed SSP, or names no file.
std::filesystem::path resolve_uri(const Source& source, const XmlFile& file, pugi::xml_node node,
                                  const std::string& uri);

/// <Units> and <Enumerations> of a file's root element, or of an inline ParameterSet.
Definitions read_definitions(const XmlFile& file, pugi::xml_node root);

/// The unit that the attribute `unit` of a type element names: as defined, else without base. Nothing without it.
std::optional<modeldesc::Unit> read_unit(pugi::xml_node type, const Definitions& definitions);

/// The transformation and suppressUnitConversion of a <Connection> or <MappingEntry>.
Transformation read_transformation(const XmlFile& file, pugi::xml_node node);

/// An SSD (SSP 2.0, chapter 5) with all that its system refers to.
struct Document {
  std::shared_ptr<const XmlFile> file;  ///< for the sections that are read from it later
  Element system;
};

/// Reads an SSD and, in place of each component that is another SSD, the system of that one. Throws InputError naming
/// file, line and element.
Document read_document(const Source& source, const std::filesystem::path& ssd);

}  // namespace mebots::master::ssp
