// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "description.hpp"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::modeldesc {

/// The modelDescription.xml of a description as plain data, GUID included: the GUID is made from the content, so
/// that the same description always has the same one and a changed description another.
ModelDescription to_model_description(const Description& description);

/// A page about the FMU for people: what it is and its variables.
std::string write_html(const ModelDescription& description);
/// The same about the FMU of FMI 3.0.
std::string write_fmi3_html(const Description& description, const ModelDescription& common);

/// modelDescription.xml of FMI 3.0; `common` is what to_model_description() makes of the same description. The token is
/// made as the GUID is.
struct Fmi3Text {
  std::string xml;
  std::string token;
};
Fmi3Text write_fmi3_xml(const Description& description, const ModelDescription& common);

/// terminalsAndIcons.xml of FMI 3.0; empty if there would be nothing in it.
std::string write_terminals_and_icons(const Description& description, bool has_icon);

/// The digest of the text in the form of a GUID.
std::string token_of(const std::string& text);

struct GenerateOptions {
  std::vector<FmiVersion> fmi;  ///< versions to write for; empty = as the description says
  bool has_icon = false;        ///< a picture goes into the archive
};

/// Writes modelDescription.xml, index.html, variables.hpp, binding.hpp and variable_table.cpp into `folder`; for
/// FMI 3.0 terminalsAndIcons.xml as well. With both versions, what is of FMI 3.0 alone goes to `folder`/fmi3.
void generate(const Description& description, const std::filesystem::path& folder, const GenerateOptions& options = {});

}  // namespace mebots::modeldesc

/// The three C++ files that the build makes of a description.
namespace mebots::modeldesc {

/// variables.hpp: Parameters, Inputs, Outputs, Variables; knows nothing of FMI.
std::string variables_header(const Description& description);

/// binding.hpp: declares the make_model() that fmu.cpp defines.
std::string binding_header(const Description& description);

/// variable_table.cpp: defines the mebots::fmu::Definition that the shell serves. The token is empty for an FMU of
/// FMI 2.0 only.
std::string variable_table_source(const Description& description, const std::string& guid, const std::string& token);

/// True for a name that C++ takes for a variable: letters, digits, `_`, and no keyword.
bool is_cpp_identifier(std::string_view name);

/// True for `a::b::c`.
bool is_cpp_namespace(std::string_view name);

/// True for FMI's structured names: identifiers with `[n]` behind them, joined by dots.
bool is_structured_name(std::string_view name);

/// The FMI name as a C++ one: `.`, `[` and `]` become `_`, none doubled and none at the end.
std::string to_cpp_name(std::string_view fmi_name);

/// The text as a C++ string literal, quotes included.
std::string cpp_literal(std::string_view text);

/// Throws mebots::Error naming the file.
void write_text_file(const std::filesystem::path& file, const std::string& text);

/// The SHA-256 digest as 64 lower-case hexadecimal digits.
std::string sha256_hex(std::string_view bytes);

}  // namespace mebots::modeldesc
