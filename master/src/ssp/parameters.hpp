// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "files.hpp"
#include "xml_file.hpp"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace mebots::master::ssp {

/// A value for a variable, named relative to the element that the binding belongs to.
struct Parameter {
  std::string name;
  nlohmann::ordered_json value;
  std::string place;
};

/// The files of an SSP, and what the SSP is called.
struct Source {
  const Files& files;
  std::string archive;
};

/// A relative URI as a path inside the SSP. Throws InputError for one that is absolute, leaves the SSP, or names no
/// file.
std::filesystem::path resolve_uri(const Source& source, const XmlFile& file, pugi::xml_node node,
                                  const std::string& uri);

/// All values of an element's <ParameterBindings>, SSV and SSM inline or in files, later ones after earlier ones:
/// they override.
std::vector<Parameter> read_parameter_bindings(const Source& source, const XmlFile& file, pugi::xml_node element);

}  // namespace mebots::master::ssp
