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

/// Selects the wrappers and observers of slaves. All objects to which the members point must outlive the Ensemble.
struct SlaveOptions {
  Statistics* statistics = nullptr;  ///< counts and times calls; may be null
  /// Receives the statistics of continuous systems; may be null.
  std::vector<SolverStatistics>* solvers = nullptr;
  std::vector<InstanceLoss>* losses = nullptr;     ///< indexed by instance; null: every failure ends the run
  const OverrideSchedule* overrides = nullptr;     ///< may be null
  const std::atomic<bool>* interrupted = nullptr;  ///< true ends the run; may be null
};

}  // namespace mebots::master
