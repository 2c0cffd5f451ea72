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

/// Checks the names, kinds and sizes of an archive's entries, without unpacking them. Throws mebots::Error if the file
/// is not a zip archive.
void check_archive(const std::filesystem::path& archive, Findings findings);
/// Checks an archive that is already open (libzip's zip_t).
void check_archive(zip& archive, Findings findings);

/// Compares the text of a modelDescription.xml with the grammar of its FMI version. Checks the order and number of
/// elements, the attributes and the form of their values, and the encoding.
void check_schema(std::string_view text, Findings findings);
/// Compares the text of a terminalsAndIcons.xml with its grammar.
void check_terminals_schema(std::string_view text, Findings findings);

using modeldesc::ModelDescription;

/// Checks the identifier, version, capabilities, log categories, default experiment and sources of the description.
void check_head(const ModelDescription& model, const std::filesystem::path& folder, Findings findings);
/// Checks that all units, display units and types are defined, and that their numbers are valid.
void check_units_and_types(const ModelDescription& model, Findings findings);
/// Checks that each variable's combination of causality, variability, initial and start is permitted. Checks that start
/// values are within their limits, or are items of their enumeration.
void check_variables(const ModelDescription& model, Findings findings);
/// Checks that names are unique and printable. If the description declares structured names, checks their grammar.
void check_names(const ModelDescription& model, Findings findings);
/// Checks that variables with the same value reference have consistent declarations.
void check_aliases(const ModelDescription& model, Findings findings);
/// Checks that Outputs and InitialUnknowns have all required entries and no others.
void check_structure(const ModelDescription& model, Findings findings);
/// Checks that each OSMP binary consists of three Integers that have the same causality and the start value 0.
void check_osmp(const ModelDescription& model, Findings findings);

/// Returns true if the name follows the structured naming convention of FMI. Such a name consists of identifiers,
/// `der(...)`, array indices and quoted names.
bool is_structured_name(std::string_view name);

/// Checks the platforms and files below binaries/ of the unpacked FMU in `folder`. `identifier` is the name of the
/// libraries without extension.
void check_platforms(const modeldesc::ModelDescription& model, const std::string& identifier,
                     const std::filesystem::path& folder, Findings findings);
/// Checks that the library's header matches `expected`, the platform of the folder that contains the library.
void check_machine(const std::filesystem::path& library, const modeldesc::Platform& expected, Findings findings);
/// Returns whether the library exists and is built for this machine. Throws Error if the library cannot be read.
bool is_own_binary(const std::filesystem::path& library);
/// Adds a warning if the library for this machine does not exist.
void check_own_binary(const std::filesystem::path& library, Findings findings);
/// Checks that the library exports the functions that FMI 2.0 requires for an FMU of this kind.
void check_symbols(const modeldesc::ModelDescription& model, master::FmuKind kind, const std::filesystem::path& library,
                   Findings findings);
/// Checks that the library exports no functions except those of FMI 2.0.
void check_other_symbols(const std::filesystem::path& library, Findings findings);
/// True if the library exports all functions that the experiments call on an FMU of this kind.
bool can_be_run(const modeldesc::ModelDescription& model, master::FmuKind kind, const std::filesystem::path& library);
/// Checks that the dynamic loader finds every library that this library needs, directly or through needed libraries in
/// the same folder.
void check_needed_libraries(const std::filesystem::path& library, Findings findings);

/// Returns the path at which the shared library for this machine must be.
std::filesystem::path library_path(const std::string& identifier, const std::filesystem::path& folder);

}  // namespace mebots::check
