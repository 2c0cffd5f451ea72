// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace mebots::app {

/// Writes the folder of a new FMU and says what to do next. Returns the exit code: 0, or 2 when it cannot be written.
int new_fmu_command(const std::filesystem::path& description, const std::filesystem::path& out);

}  // namespace mebots::app
