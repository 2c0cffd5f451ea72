// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace mebots::master {

/// Counts the steps, evaluations and events of a solver.
struct SolverCounts {
  std::int64_t steps = 0;
  std::int64_t rejected_steps = 0;  ///< steps that the error test rejected, or in which Newton's method failed
  std::int64_t evaluations = 0;     ///< evaluations of the right-hand side, including those for Jacobians
  std::int64_t jacobians = 0;
  std::int64_t restarts = 0;  ///< restarts of the solver at order 1
  std::int64_t state_events = 0;
  std::int64_t time_events = 0;
  std::int64_t step_events = 0;   ///< events that completedIntegratorStep requested
  std::int64_t input_events = 0;  ///< changes of discrete inputs at communication points

  void visit(state::Visitor& v) {
    v("steps", steps);
    v("rejected_steps", rejected_steps);
    v("evaluations", evaluations);
    v("jacobians", jacobians);
    v("restarts", restarts);
    v("state_events", state_events);
    v("time_events", time_events);
    v("step_events", step_events);
    v("input_events", input_events);
  }
};

/// The statistics of the solver of one continuous system.
struct SolverStatistics {
  std::vector<std::string> members;  ///< names of the instances
  std::int64_t states = 0;
  std::int64_t event_indicators = 0;
  double relative_tolerance = 0;
  SolverCounts counts;
};

}  // namespace mebots::master
