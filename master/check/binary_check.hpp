// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "finding.hpp"

#include "mebots/modeldesc/model_description.hpp"

#include <filesystem>

namespace mebots::check {

/// Platforms and files under binaries/ of the unpacked FMU in `folder`.
void check_platforms(const modeldesc::ModelDescription& model, const std::filesystem::path& folder, Findings findings);
/// The functions that the standard demands are exported, and nothing else.
void check_symbols(const modeldesc::ModelDescription& model, const std::filesystem::path& library, Findings findings);
/// True when the library brings all functions that the experiments with it call.
bool can_be_run(const modeldesc::ModelDescription& model, const std::filesystem::path& library);
/// Every library that is needed, directly or by those beside it, can be found as the system's loader looks for it.
void check_needed_libraries(const std::filesystem::path& library, Findings findings);

/// Where the shared library for this machine must be.
std::filesystem::path library_path(const modeldesc::ModelDescription& model, const std::filesystem::path& folder);

}  // namespace mebots::check
