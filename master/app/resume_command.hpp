// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace mebots::app {

/// Goes on with the run whose results are in `folder` from its last checkpoint. Exit codes as run_command().
int resume_command(const std::filesystem::path& folder, bool quiet);

}  // namespace mebots::app
