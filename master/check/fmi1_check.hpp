// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "finding.hpp"
#include "mebots/modeldesc/model_description.hpp"

#include <filesystem>

/// Checks of FMI 1.0 co-simulation FMUs, limited to what every tool needs.
namespace mebots::check {

/// Checks that names are unique, that dependencies exist, and that inputs and constants have start values.
void check_fmi1_variables(const modeldesc::ModelDescription& model, Findings findings);
/// Checks that the library exports the FMI 1.0 functions with the model identifier as prefix.
void check_fmi1_symbols(const modeldesc::ModelDescription& model, const std::filesystem::path& library,
                        Findings findings);

}  // namespace mebots::check
