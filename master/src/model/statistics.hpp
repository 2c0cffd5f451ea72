// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/resolved_system.hpp"
#include "model/solver_statistics.hpp"
#include "model/step_statistics.hpp"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace mebots::master {

struct InstanceStatistics {
  std::string name;
  std::int64_t calls = 0;
  std::int64_t steps = 0;
  double time_s = 0;       ///< sum over all calls
  double step_time_s = 0;  ///< sum over all steps
  double slowest_s = 0;
  std::int64_t slowest_at_ns = 0;  ///< simulated time at the start of the slowest step
};

/// The wall time of a run, divided among its instances. It differs between runs with equal inputs.
struct Statistics {
  std::vector<InstanceStatistics> instances;  ///< in the order of the config
};

/// Returns the statistics of the solvers as JSON. They are equal for runs with equal inputs.
nlohmann::ordered_json solvers_json(const std::vector<SolverStatistics>& solvers);

std::vector<std::string> solvers_table(const std::vector<SolverStatistics>& solvers);

/// Returns the statistics of step control as JSON. The lengths of steps are in seconds.
nlohmann::ordered_json step_control_json(const ResolvedSystem& system, const StepStatistics& steps);

std::string step_control_line(const ResolvedSystem& system, const StepStatistics& steps);

/// Returns the statistics as JSON, with times in seconds. `total_s` is the wall time of initialisation and stepping.
/// The time outside of calls to instances is reported as the time of the master.
nlohmann::ordered_json statistics_json(const Statistics& statistics, double total_s);

std::vector<std::string> statistics_table(const Statistics& statistics, double total_s);

}  // namespace mebots::master
