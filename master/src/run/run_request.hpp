// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"
#include "model/system_description.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace mebots::master {

/// Everything that a run is asked for, by whichever door: with the files that it names, the run is made of nothing
/// else. A checkpoint carries it, so that another process can go on.
struct RunRequest {
  std::filesystem::path config;                    ///< config, FMU or SSP
  std::vector<Setting> settings;                   ///< later ones win
  std::vector<std::filesystem::path> scenarios;    ///< files with more overrides, after the config's
  std::vector<std::filesystem::path> inputs;       ///< CSV files with signals for free inputs, after the config's
  std::optional<std::int64_t> stop_time_ns;        ///< instead of the config's
  std::optional<WrittenTime> step;                 ///< communication step, for an FMU or an SSP that has none
  std::optional<std::vector<std::string>> record;  ///< name patterns, in place of `variables` and `exclude`
  std::filesystem::path folder;                    ///< where the result files go; empty = no files
  bool in_memory = false;                          ///< keep the recorded rows in memory, too
  bool isolate = false;                            ///< every instance in a process of its own
  bool statistics = false;                         ///< measure where the wall time goes
  std::int64_t checkpoint_every_ns = 0;            ///< simulated time from checkpoint to checkpoint; 0 = none

  void visit(state::Visitor& v);
};

/// With every path made absolute: what stands in a checkpoint must hold from any working folder.
RunRequest with_absolute_paths(RunRequest request);

}  // namespace mebots::master
