// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "child.hpp"

#include "mebots/modeldesc/model_description.hpp"

#include <filesystem>
#include <vector>

namespace mebots::check {

/// Returns experiments on a model exchange FMU (FMI 2.0 or 3.0), unpacked in `folder`. The experiments use the master's
/// slave classes.
std::vector<ChildProbe> exchange_probes(const std::filesystem::path& archive, const std::filesystem::path& folder,
                                        const modeldesc::ModelDescription& model);

}  // namespace mebots::check
