// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "finding.hpp"

#include "mebots/modeldesc/xml.hpp"

#include <pugixml.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

/// Checks of FMI 3.0 FMUs. The checks examine the text of the files, so that findings have line numbers.
namespace mebots::check {

using modeldesc::words_of;

/// A variable as declared, with FMI's defaults for missing attributes.
struct Fmi3Declared {
  pugi::xml_node node;
  std::string name;
  std::uint32_t reference = 0;
  std::string type;  ///< name of the XML element
  std::string causality;
  std::string variability;
  std::string initial;  ///< empty for inputs, Clocks and the independent variable
  std::vector<std::string> starts;
  std::size_t elements = 1;  ///< product of the dimensions' start values

  bool is_float() const { return type.starts_with("Float"); }
};

/// A modelDescription.xml of FMI 3.0, which may be invalid. Unlike the reader in modeldesc, does not stop at the first
/// error, so that `mebots check` can report all errors with line numbers.
class Fmi3Description {
 public:
  /// Throws Error if the text is not XML.
  explicit Fmi3Description(std::string text);

  pugi::xml_node root() const { return document_.document_element(); }
  const std::vector<Fmi3Declared>& variables() const { return variables_; }
  /// Returns the variable with this value reference, or null.
  const Fmi3Declared* find(std::uint32_t reference) const;
  /// Returns a place such as "line 12".
  std::string line(pugi::xml_node node) const;
  /// Returns a place such as "line 12, cell.voltage".
  std::string place(const Fmi3Declared& variable) const;
  /// Returns the elements of the FMU's interface types, such as <CoSimulation>.
  std::vector<pugi::xml_node> interfaces() const;

 private:
  void read(pugi::xml_node node);

  std::string text_;
  pugi::xml_document document_;
  std::vector<Fmi3Declared> variables_;
  std::map<std::uint32_t, std::size_t> by_reference_;
};

/// Checks the identifiers, capabilities, log categories and default experiment.
void check_fmi3_head(const Fmi3Description& description, Findings findings);
/// Checks that names (including aliases) and value references are unique.
void check_fmi3_names(const Fmi3Description& description, Findings findings);
/// Checks that each variable's causality, variability, initial and start are a permitted combination. Checks that there
/// is exactly one independent variable.
void check_fmi3_kinds(const Fmi3Description& description, Findings findings);
/// Checks that units and types are defined, that start values are within their limits, and that enumerations start with
/// an item.
void check_fmi3_types(const Fmi3Description& description, Findings findings);
/// Checks dimensions, structural parameters and the number of start values.
void check_fmi3_arrays(const Fmi3Description& description, Findings findings);
/// Checks the intervals of Clocks, and references to Clocks and previous values.
void check_fmi3_clocks(const Fmi3Description& description, Findings findings);
/// Checks that ModelStructure lists each output and each initial unknown once, and that their dependencies exist.
void check_fmi3_structure(const Fmi3Description& description, Findings findings);

/// Checks terminalsAndIcons/terminalsAndIcons.xml and its pictures, if they exist.
void check_fmi3_terminals(const Fmi3Description& description, const std::filesystem::path& folder, Findings findings);
/// Checks the folder names in extra/ and the manifests of layered standards.
void check_extra(const std::filesystem::path& folder, Findings findings);
/// Checks that each folder in binaries/ is a platform and contains all declared libraries.
void check_fmi3_platforms(const Fmi3Description& description, const std::filesystem::path& folder, Findings findings);
/// Checks that the library exports all functions of the FMU's interface types.
void check_fmi3_symbols(const Fmi3Description& description, const std::filesystem::path& library, Findings findings);

/// Returns the path of the library for this machine and the first interface type. The file may be missing.
std::filesystem::path fmi3_library_path(const Fmi3Description& description, const std::filesystem::path& folder);

}  // namespace mebots::check
