// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/override_schedule.hpp"
#include "model/run_course.hpp"
#include "model/statistics.hpp"

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace mebots::master {

/// Selects wrappers and observers of slaves. All objects to which the members point must outlive the ensemble.
struct SlaveOptions {
  Statistics* statistics = nullptr;  ///< counts and times calls; null: calls are not counted
  /// Receives the statistics of continuous systems; null: not collected.
  std::vector<SolverStatistics>* solvers = nullptr;
  std::vector<InstanceLoss>* losses = nullptr;     ///< indexed by instance; null: every failure ends the run
  const OverrideSchedule* overrides = nullptr;     ///< overrides of variables; null: none
  const std::atomic<bool>* interrupted = nullptr;  ///< if it becomes true, the run ends; null: never
};

}  // namespace mebots::master
