// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "finding.hpp"
#include "mebots/modeldesc/model_description.hpp"

#include <filesystem>

/// Declares checks of FMI 1.0 co-simulation FMUs. They cover what every tool needs in order to run such an FMU.
namespace mebots::check {

/// Checks that names are unique, that dependencies name variables, and that inputs and constants have start values.
void check_fmi1_variables(const modeldesc::ModelDescription& model, Findings findings);
/// Checks that the library exports the functions of FMI 1.0 with the model's identifier as prefix.
void check_fmi1_symbols(const modeldesc::ModelDescription& model, const std::filesystem::path& library,
                        Findings findings);

}  // namespace mebots::check
