// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "child.hpp"

#include "mebots/modeldesc/model_description.hpp"

#include <filesystem>
#include <vector>

namespace mebots::check {

/// Returns experiments on a model exchange FMU of FMI 2.0 or 3.0 that is unpacked into `folder`. The experiments call
/// the FMU through the master's slave class for its FMI version.
std::vector<ChildProbe> exchange_probes(const std::filesystem::path& archive, const std::filesystem::path& folder,
                                        const modeldesc::ModelDescription& model);

}  // namespace mebots::check
