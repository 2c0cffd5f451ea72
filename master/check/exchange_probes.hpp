// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "child.hpp"

#include "mebots/modeldesc/model_description.hpp"

#include <filesystem>
#include <vector>

namespace mebots::check {

/// Returns experiments with an FMU for model exchange, of FMI 2.0 or 3.0, unpacked into `folder`. The experiments call
/// the FMU through the master's slave class for its version of FMI.
std::vector<ChildProbe> exchange_probes(const std::filesystem::path& archive, const std::filesystem::path& folder,
                                        const modeldesc::ModelDescription& model);

}  // namespace mebots::check
