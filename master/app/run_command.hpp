// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace mebots::app {

/// What `mebots run` was asked for.
struct RunOptions {
  std::filesystem::path config;
  std::filesystem::path out;               ///< empty = results/<name of the config>
  std::vector<std::string> sets;           ///< INSTANCE.VARIABLE=VALUE
  std::optional<std::string> stop_time_s;  ///< as typed
  std::optional<double> step_s;            ///< for an SSP that says none
  bool statistics = false;                 ///< show and write where the wall time went
  bool quiet = false;
};

/// Runs a config. Returns the exit code: 0 the simulation ran to its end, 1 it failed or was interrupted,
/// 2 the input cannot be used.
int run_command(const RunOptions& options);

}  // namespace mebots::app
