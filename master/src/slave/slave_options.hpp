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

/// What stands between an ensemble and its slaves. All that is pointed to must outlive the ensemble.
struct SlaveOptions {
  Statistics* statistics = nullptr;                  ///< where calls are counted; null = nowhere
  std::vector<SolverStatistics>* solvers = nullptr;  ///< of the continuous systems; null = nowhere
  std::vector<InstanceLoss>* losses = nullptr;       ///< one per instance; null = every failure ends the run
  const OverrideSchedule* overrides = nullptr;       ///< changes variables between slaves; null = no changes
  const std::atomic<bool>* interrupted = nullptr;    ///< set by whoever wants the end; null = nobody does
};

}  // namespace mebots::master
