// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "finding.hpp"

#include "mebots/modeldesc/model_description.hpp"

#include <filesystem>

namespace mebots::check {

using modeldesc::ModelDescription;

/// Identifier, version, capabilities, log categories, default experiment, sources.
void check_head(const ModelDescription& model, const std::filesystem::path& folder, Findings findings);
/// Units, display units and types are defined, and their numbers make sense.
void check_units_and_types(const ModelDescription& model, Findings findings);
/// Legal combinations of causality, variability, initial and start; starts within limits and of known items.
void check_variables(const ModelDescription& model, Findings findings);
/// Names unique and printable, and of the grammar of structured names where the description claims it.
void check_names(const ModelDescription& model, Findings findings);
/// Variables that share a value reference agree with each other.
void check_aliases(const ModelDescription& model, Findings findings);
/// Outputs and InitialUnknowns are complete, and hold nothing else.
void check_structure(const ModelDescription& model, Findings findings);
/// OSMP binaries are whole: three Integers of one causality, start 0.
void check_osmp(const ModelDescription& model, Findings findings);

/// True for a name as the structured naming convention builds it: identifiers, `der(...)`, array indices, quoted names.
bool is_structured_name(std::string_view name);

}  // namespace mebots::check
