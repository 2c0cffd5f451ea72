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

/// Measures the wall time of the calls to an instance.
struct InstanceStatistics {
  std::string name;
  std::int64_t calls = 0;
  std::int64_t steps = 0;
  double time_s = 0;               ///< sum over all calls
  double step_time_s = 0;          ///< sum over all steps
  double slowest_s = 0;            ///< time of the slowest step
  std::int64_t slowest_at_ns = 0;  ///< simulated time at the start of the slowest step
};

/// The wall time of a run, divided among its instances. It is not written to results.csv, because it differs between
/// equal runs.
struct Statistics {
  std::vector<InstanceStatistics> instances;  ///< in the order of the config
};

/// Returns the statistics of all continuous systems as JSON. The JSON is the same for runs with equal inputs.
nlohmann::ordered_json solvers_json(const std::vector<SolverStatistics>& solvers);

/// Formats the statistics of all continuous systems as lines of text.
std::vector<std::string> solvers_table(const std::vector<SolverStatistics>& solvers);

/// Returns the statistics of step control as JSON. Lengths of steps are in seconds.
nlohmann::ordered_json step_control_json(const ResolvedSystem& system, const StepStatistics& steps);

/// Formats the statistics of step control as a line of text.
std::string step_control_line(const ResolvedSystem& system, const StepStatistics& steps);

/// Returns the statistics as JSON, with times in seconds. `total_s` is the wall time of initialisation and stepping.
/// The part of it that is outside of calls to instances is reported as the master's time.
nlohmann::ordered_json statistics_json(const Statistics& statistics, double total_s);

/// Formats the statistics as lines of text.
std::vector<std::string> statistics_table(const Statistics& statistics, double total_s);

}  // namespace mebots::master
