// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "description.hpp"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::modeldesc {

/// Returns the modelDescription.xml of a description as plain data. The GUID is a hash of the content: equal
/// descriptions have equal GUIDs.
/// `source_files` are the sources in the archive that an importing tool can compile.
ModelDescription to_model_description(const Description& description, std::vector<std::string> source_files = {});

/// Returns an HTML page about the FMU and its variables.
std::string write_html(const ModelDescription& description);
/// Returns an HTML page about the FMU of FMI 3.0.
std::string write_fmi3_html(const Description& description, const ModelDescription& common);

/// The modelDescription.xml of FMI 3.0. `common` is the result of to_model_description() for the same description. The
/// token is computed like the GUID.
struct Fmi3Text {
  std::string xml;
  std::string token;
};
Fmi3Text write_fmi3_xml(const Description& description, const ModelDescription& common);

/// Returns terminalsAndIcons.xml of FMI 3.0; empty if the FMU has neither terminals nor an icon.
std::string write_terminals_and_icons(const Description& description, bool has_icon);

/// Returns buildDescription.xml of FMI 3.0 for these sources.
std::string write_build_description(const std::string& model_identifier, const std::vector<std::string>& sources);

/// Returns a hash of the text in the form of a GUID.
std::string token_of(const std::string& text);

struct GenerateOptions {
  std::vector<FmiVersion> fmi;  ///< versions to write; empty = those of the description
  bool has_icon = false;        ///< the archive contains a picture
  /// The sources in the archive, relative to sources/; empty = it has none.
  std::vector<std::string> fmi2_sources = {};
  std::vector<std::string> fmi3_sources = {};
};

/// Writes modelDescription.xml, index.html, variables.hpp, binding.hpp and variable_table.cpp into `folder`, and
/// terminalsAndIcons.xml and, if there are sources, buildDescription.xml for FMI 3.0. With both versions, the files of
/// FMI 3.0 alone are in `folder`/fmi3.
void generate(const Description& description, const std::filesystem::path& folder, const GenerateOptions& options = {});

}  // namespace mebots::modeldesc

/// The three C++ files that the build generates from a description.
namespace mebots::modeldesc {

/// Returns variables.hpp, which defines Parameters, Inputs, Outputs and Variables. It does not depend on FMI.
std::string variables_header(const Description& description);

/// Returns binding.hpp, which declares the make_model() that fmu.cpp defines.
std::string binding_header(const Description& description);

/// Returns variable_table.cpp, which defines the mebots::fmu::Definition that the FMI functions of the FMU use. The
/// token is empty if the FMU supports FMI 2.0 only.
std::string variable_table_source(const Description& description, const std::string& guid, const std::string& token);

/// True if the text is a C++ identifier and not a keyword.
bool is_cpp_identifier(std::string_view name);

/// True for text such as `a::b::c`.
bool is_cpp_namespace(std::string_view name);

/// True for FMI's structured names: identifiers joined by dots, each with an optional `[n]`.
bool is_structured_name(std::string_view name);

/// Converts an FMI name to a C++ name: `.`, `[` and `]` become `_`, never doubled and never at the end.
std::string to_cpp_name(std::string_view fmi_name);

/// Returns the text as a C++ string literal, quotes included.
std::string cpp_literal(std::string_view text);

/// Writes a file. Throws mebots::Error with the file's name if that fails.
void write_text_file(const std::filesystem::path& file, const std::string& text);

/// Returns the SHA-256 digest as 64 lower-case hexadecimal digits.
std::string sha256_hex(std::string_view bytes);

}  // namespace mebots::modeldesc
