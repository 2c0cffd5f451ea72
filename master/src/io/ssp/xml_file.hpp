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

/// An XML file of an SSP. Its functions ignore namespace prefixes of elements.
class XmlFile {
 public:
  /// Parses the file. Messages contain `name`. Throws InputError with the line if the text is not well-formed XML.
  XmlFile(std::string_view bytes, std::string name);
  XmlFile(const XmlFile&) = delete;
  XmlFile& operator=(const XmlFile&) = delete;

  const std::string& name() const { return name_; }
  pugi::xml_node root() const { return document_.document_element(); }
  /// Returns the place of an element, such as "SystemStructure.ssd, line 12".
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

/// Returns the name of an element without its namespace prefix.
std::string_view local_name(pugi::xml_node node);
/// Returns the first child with this local name; a null node if no child has it.
pugi::xml_node child(pugi::xml_node node, std::string_view name);
std::vector<pugi::xml_node> children(pugi::xml_node node, std::string_view name);

/// Parses a finite number. Returns nullopt for any other text.
std::optional<double> parse_number(std::string_view text);
/// Parses a Boolean of XML Schema: true, false, 1 or 0. Returns nullopt for any other text.
std::optional<bool> parse_flag(std::string_view text);
std::vector<std::string> words_of(const std::string& text);

}  // namespace mebots::master::ssp

/// Reads the elements that are common to SSD, SSV and SSM files (SSP 2.0, chapter 4).
namespace mebots::master::ssp {

struct Source {
  const Files& files;
  std::string archive;
  std::filesystem::path base;  ///< folder of the SSD, to which relative URIs refer
  std::vector<std::string>& notices;
};

/// Returns the path in `source.files` of a URI's file. Throws InputError if the URI does not refer to a file, if the
/// file does not exist, or if it is outside of an SSP whose files are not open (see Files::is_open()).
std::filesystem::path resolve_uri(const Source& source, const XmlFile& file, pugi::xml_node node,
                                  const std::string& uri);

/// Reads <Units> and <Enumerations> of the root element of a file, or of an inline ParameterSet.
Definitions read_definitions(const XmlFile& file, pugi::xml_node root);

/// Returns the unit of a type element; nullopt if the element has no attribute `unit`. If the file does not define the
/// unit, the result contains only its name.
std::optional<modeldesc::Unit> read_unit(pugi::xml_node type, const Definitions& definitions);

Transformation read_transformation(const XmlFile& file, pugi::xml_node node);

/// The content of an SSD (SSP 2.0, chapter 5) and of all files to which its system refers.
struct Document {
  std::shared_ptr<const XmlFile> file;  ///< the SSD, for sections that are read later
  Element system;
};

/// Reads an SSD. If the source of a component is another SSD, replaces the component by the system of that SSD. Throws
/// InputError with file, line and element of a mistake.
Document read_document(const Source& source, const std::filesystem::path& ssd);

}  // namespace mebots::master::ssp
