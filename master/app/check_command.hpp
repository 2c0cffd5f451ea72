// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace mebots::app {

/// What `mebots check` was asked for.
struct CheckOptions {
  std::filesystem::path fmu;
  bool json = false;
  bool files_only = false;
  double half_step_tolerance = 1e-3;
  double deadline_s = 30;
};

/// Checks an FMU and prints the report. Returns the exit code: 0 clean, 1 findings, 2 the file cannot be read.
int check_command(const CheckOptions& options);

}  // namespace mebots::app
