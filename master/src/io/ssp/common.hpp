// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "files.hpp"
#include "model.hpp"
#include "xml_file.hpp"

#include <string>
#include <vector>

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

}  // namespace mebots::master::ssp
