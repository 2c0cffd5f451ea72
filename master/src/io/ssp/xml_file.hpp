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

/// An XML file of an SSP. Elements are searched by their local name, regardless of their namespace prefix.
class XmlFile {
 public:
  /// Parses the file. `name` is its name in messages. Throws InputError with the line if the text is not well-formed
  /// XML.
  XmlFile(std::string_view bytes, std::string name);
  XmlFile(const XmlFile&) = delete;
  XmlFile& operator=(const XmlFile&) = delete;

  const std::string& name() const { return name_; }
  pugi::xml_node root() const { return document_.document_element(); }
  /// Returns a text such as "SystemStructure.ssd, line 12".
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

/// Returns the element's name without its namespace prefix.
std::string_view local_name(pugi::xml_node node);
/// Returns the first child with this local name. Returns a null node if no child has this name.
pugi::xml_node child(pugi::xml_node node, std::string_view name);
std::vector<pugi::xml_node> children(pugi::xml_node node, std::string_view name);

/// Parses the text as a number. Returns nullopt if it is not a finite number.
std::optional<double> parse_number(std::string_view text);
/// Parses the text as a Boolean of XML Schema: true, false, 1 or 0. Returns nullopt for any other text.
std::optional<bool> parse_flag(std::string_view text);
/// Splits the text at white space.
std::vector<std::string> words_of(const std::string& text);

}  // namespace mebots::master::ssp

/// Reads the elements that SSD, SSV and SSM files have in common (SSP 2.0, chapter 4).
namespace mebots::master::ssp {

/// The files of an SSP, and the folder to which its relative URIs refer.
struct Source {
  const Files& files;
  std::string archive;         ///< name of the SSP
  std::filesystem::path base;  ///< folder of the SSD, to which relative URIs refer
  std::vector<std::string>& notices;
};

/// Returns the path in `source.files` of the file to which a URI refers. Throws InputError if the URI does not refer to
/// a file, if the file does not exist, or if it is outside of an SSP whose files are not open.
std::filesystem::path resolve_uri(const Source& source, const XmlFile& file, pugi::xml_node node,
                                  const std::string& uri);

/// Reads <Units> and <Enumerations> of the root element of a file, or of an inline ParameterSet.
Definitions read_definitions(const XmlFile& file, pugi::xml_node root);

/// Returns the unit that the attribute `unit` of a type element names. If the file does not define the unit, the result
/// contains only the name. Returns nullopt if the element has no such attribute.
std::optional<modeldesc::Unit> read_unit(pugi::xml_node type, const Definitions& definitions);

/// Reads the transformation and suppressUnitConversion of a <Connection> or <MappingEntry>.
Transformation read_transformation(const XmlFile& file, pugi::xml_node node);

/// An SSD (SSP 2.0, chapter 5), and the content of all files to which its system refers.
struct Document {
  std::shared_ptr<const XmlFile> file;  ///< the SSD, of which other sections are read later
  Element system;
};

/// Reads an SSD. If the source of a component is another SSD, replaces the component by the system of that SSD. Throws
/// InputError with file, line and element if there is a mistake.
Document read_document(const Source& source, const std::filesystem::path& ssd);

}  // namespace mebots::master::ssp
