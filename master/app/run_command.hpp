// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "run/checkpoint.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace mebots::app {

/// What `mebots run` was asked for.
struct RunOptions {
  std::filesystem::path config;
  std::filesystem::path out;                      ///< empty = results/<name of the config>
  std::vector<std::string> sets;                  ///< INSTANCE.VARIABLE=VALUE
  std::vector<std::string> scenarios;             ///< files with more overrides
  std::optional<std::string> stop_time_s;         ///< as typed
  bool statistics = false;                        ///< show and write where the wall time went
  bool isolate = false;                           ///< every instance in a process of its own
  std::optional<std::string> checkpoint_every_s;  ///< simulated time, as typed
  std::optional<master::Checkpoint> checkpoint;   ///< to go on from, in the folder `out`
  std::optional<double> step_s;                   ///< for an SSP that says none
  bool quiet = false;
};

/// Runs a config. Returns the exit code: 0 the simulation ran to its end, 1 it failed or was interrupted,
/// 2 the input cannot be used.
int run_command(const RunOptions& options);

}  // namespace mebots::app
