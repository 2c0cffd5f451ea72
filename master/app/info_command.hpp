// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace mebots::app {

/// Prints what an FMU, a config or an SSP (by its ending) says of itself. Returns the exit code: 0, or 2 when it
/// cannot be used.
int info_command(const std::filesystem::path& file);

}  // namespace mebots::app
