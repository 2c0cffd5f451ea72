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

/// Wrappers and observers between an ensemble and its slaves. All pointed-to objects must outlive the ensemble.
struct SlaveOptions {
  Statistics* statistics = nullptr;                  ///< counts calls; null = not counted
  std::vector<SolverStatistics>* solvers = nullptr;  ///< of the continuous systems; null = not collected
  std::vector<InstanceLoss>* losses = nullptr;       ///< by instance; null = every failure ends the run
  const OverrideSchedule* overrides = nullptr;       ///< changes variables between slaves; null = no changes
  const std::atomic<bool>* interrupted = nullptr;    ///< true requests the end of the run; null = never
};

}  // namespace mebots::master
