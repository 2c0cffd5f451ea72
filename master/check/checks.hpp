// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "finding.hpp"
#include "mebots/modeldesc/model_description.hpp"
#include "mebots/modeldesc/platform.hpp"
#include "model/fmu_kind.hpp"

#include <filesystem>
#include <string_view>

struct zip;  // libzip's zip_t

namespace mebots::check {

/// Checks names, kinds and sizes of an archive's entries without unpacking them. Throws Error if the file is not a zip
/// archive.
void check_archive(const std::filesystem::path& archive, Findings findings);
void check_archive(zip& archive, Findings findings);

/// Checks a modelDescription.xml against the grammar of its FMI version: order and number of elements, attributes and
/// their values, and the encoding.
void check_schema(std::string_view text, Findings findings);
/// Checks a terminalsAndIcons.xml against its grammar.
void check_terminals_schema(std::string_view text, Findings findings);

using modeldesc::ModelDescription;

/// Checks identifier, version, capabilities, log categories, default experiment and sources.
void check_head(const ModelDescription& model, const std::filesystem::path& folder, Findings findings);
/// Checks that all units, display units and types are defined with valid numbers.
void check_units_and_types(const ModelDescription& model, Findings findings);
/// Checks that the combination of causality, variability, initial and start is permitted for each variable. Checks that
/// start values are within their limits, or items of their enumeration.
void check_variables(const ModelDescription& model, Findings findings);
/// Checks that names are unique and printable. If the description declares structured names, checks their
/// grammar.
void check_names(const ModelDescription& model, Findings findings);
/// Checks that variables with the same value reference have consistent declarations.
void check_aliases(const ModelDescription& model, Findings findings);
/// Checks that Outputs and InitialUnknowns have all required entries and no others.
void check_structure(const ModelDescription& model, Findings findings);
/// Checks that each OSMP binary has three Integers with the same causality and the start value 0.
void check_osmp(const ModelDescription& model, Findings findings);

/// True if the name follows FMI's structured naming convention: identifiers, `der(...)`, array indices and quoted
/// names.
bool is_structured_name(std::string_view name);

/// Checks the folders and files below binaries/ in the unpacked FMU `folder`. `identifier` is the library's name
/// without extension.
void check_platforms(const modeldesc::ModelDescription& model, const std::string& identifier,
                     const std::filesystem::path& folder, Findings findings);
/// Checks that the library is built for `expected`, the platform of its folder.
void check_machine(const std::filesystem::path& library, const modeldesc::Platform& expected, Findings findings);
/// True if the library exists and is built for this machine. Throws Error if the library cannot be read.
bool is_own_binary(const std::filesystem::path& library);
/// Adds a warning if there is no library for this machine.
void check_own_binary(const std::filesystem::path& library, Findings findings);
/// Checks that the library exports all functions that FMI 2.0 requires for this kind of FMU.
void check_symbols(const modeldesc::ModelDescription& model, master::FmuKind kind, const std::filesystem::path& library,
                   Findings findings);
/// Checks that the library exports only FMI 2.0 functions.
void check_other_symbols(const std::filesystem::path& library, Findings findings);
/// True if the library exports all functions that the experiments need.
bool can_be_run(const modeldesc::ModelDescription& model, master::FmuKind kind, const std::filesystem::path& library);
/// Checks that the dynamic loader finds all libraries that this library needs, directly or through other libraries in
/// the same folder.
void check_needed_libraries(const std::filesystem::path& library, Findings findings);

/// Returns the path of the shared library for this machine.
std::filesystem::path library_path(const std::string& identifier, const std::filesystem::path& folder);

}  // namespace mebots::check
