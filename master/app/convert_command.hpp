// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace mebots::app {

/// Turns a config into an SSP or an SSP into a config, by the endings `.ssp` and `.json`. Returns the exit code.
int convert_command(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace mebots::app
