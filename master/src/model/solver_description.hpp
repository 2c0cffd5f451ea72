// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace mebots::master {

/// Multistep methods of the solver CVODE.
enum class SolverMethod : std::uint8_t {
  bdf,    ///< backward differentiation formulas of orders 1 to 5, for stiff systems
  adams,  ///< Adams-Moulton formulas of orders 1 to 12, for systems that are not stiff
};

/// Settings of the solver of a continuous system. docs/master/model-exchange.md lists the defaults.
struct SolverDescription {
  SolverMethod method = SolverMethod::bdf;
  std::optional<double> relative_tolerance = {};
  std::optional<double> absolute_tolerance = {};  ///< multiplied by the nominal value of each state
  std::optional<double> max_step_s = {};
  std::int64_t max_steps = 100'000;  ///< maximum number of solver steps in one communication step
  bool restarts_at_points = false;   ///< true: the solver restarts at every communication point
  std::string place = {};
};

}  // namespace mebots::master
