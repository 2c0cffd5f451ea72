// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "description.hpp"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::modeldesc {

/// Converts a description to the content of its modelDescription.xml. The GUID is a hash of the content. `source_files`
/// are the sources in the archive that an importing tool can compile.
ModelDescription to_model_description(const Description& description, std::vector<std::string> source_files = {});

/// Returns an HTML page that documents the FMU and its variables.
std::string write_html(const ModelDescription& description);
/// Returns the same page as write_html() for an FMU of FMI 3.0. `common` is the result of to_model_description() for
/// the same description.
std::string write_fmi3_html(const Description& description, const ModelDescription& common);

/// The modelDescription.xml of FMI 3.0. The token is a hash of its content, like the GUID of FMI 2.0.
struct Fmi3Text {
  std::string xml;
  std::string token;
};
/// `common` is the result of to_model_description() for the same description.
Fmi3Text write_fmi3_xml(const Description& description, const ModelDescription& common);

/// Returns the text of terminalsAndIcons.xml for FMI 3.0; empty if the FMU has neither terminals nor an icon.
std::string write_terminals_and_icons(const Description& description, bool has_icon);

/// Returns the text of a buildDescription.xml for FMI 3.0 with these sources.
std::string write_build_description(const std::string& model_identifier, const std::vector<std::string>& sources);

/// Returns a hash of the text, written as a GUID.
std::string token_of(const std::string& text);

struct GenerateOptions {
  std::vector<FmiVersion> fmi;  ///< versions of FMI to generate; empty: those of the description
  bool has_icon = false;        ///< the archive contains a picture
  /// Paths of source files in the archive, relative to sources/. Both lists are empty if the archive has no sources.
  std::vector<std::string> fmi2_sources = {};
  std::vector<std::string> fmi3_sources = {};
};

/// Writes modelDescription.xml, index.html, variables.hpp, binding.hpp and variable_table.cpp into `folder`. For FMI
/// 3.0, also writes terminalsAndIcons.xml and, if the archive has sources, buildDescription.xml. If both versions are
/// generated, writes the files that only FMI 3.0 uses into `folder`/fmi3.
void generate(const Description& description, const std::filesystem::path& folder, const GenerateOptions& options = {});

}  // namespace mebots::modeldesc

namespace mebots::modeldesc {

/// Returns variables.hpp, which defines Parameters, Inputs, Outputs and Variables. This header does not depend on FMI.
std::string variables_header(const Description& description);

/// Returns binding.hpp, which declares make_model(). The file fmu.cpp of the FMU defines this function.
std::string binding_header(const Description& description);

/// Returns variable_table.cpp, which defines the FMU's mebots::fmu::Definition. `token` is the instantiation token.
/// `token` is empty if the FMU supports only FMI 2.0.
std::string variable_table_source(const Description& description, const std::string& guid, const std::string& token);

/// True for a C++ identifier that is not a keyword.
bool is_cpp_identifier(std::string_view name);

/// True for C++ identifiers joined by `::`, such as `a::b::c`.
bool is_cpp_namespace(std::string_view name);

/// True for a structured name of FMI: identifiers joined by dots. Each identifier may have an index `[n]`.
bool is_structured_name(std::string_view name);

/// Converts an FMI name to a C++ name: `.`, `[` and `]` become `_`. Replaces several `_` in a row by one, and removes
/// `_` at the end.
std::string to_cpp_name(std::string_view fmi_name);

std::string cpp_literal(std::string_view text);

/// Throws mebots::Error with the file's name if the file cannot be written.
void write_text_file(const std::filesystem::path& file, const std::string& text);

/// Returns the SHA-256 digest of the bytes as 64 lower-case hexadecimal digits.
std::string sha256_hex(std::string_view bytes);

}  // namespace mebots::modeldesc
