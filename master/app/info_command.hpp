// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace mebots::app {

/// Prints what an FMU says of itself. Returns the exit code: 0, or 2 when it is no usable FMU.
int info_command(const std::filesystem::path& fmu);

}  // namespace mebots::app
