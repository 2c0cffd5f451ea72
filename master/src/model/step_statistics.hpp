// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"

#include <cstdint>
#include <vector>

namespace mebots::master {

/// Counts the communication steps of a run with step control. Lengths are multiples of the system's step.
struct StepStatistics {
  std::int64_t steps = 0;
  std::int64_t rejected = 0;  ///< steps that were repeated
  std::int64_t above = 0;     ///< steps that were accepted although their error exceeded the tolerance
  std::int64_t smallest = 0;
  std::int64_t largest = 0;
  double error_sum = 0;  ///< sum of the errors; each error is divided by its limit
  double largest_error = 0;
  std::vector<std::int64_t> worst;  ///< number of steps in which each input or bond had the largest error

  void add(std::int64_t length, double error);

  void visit(state::Visitor& v) {
    v("steps", steps);
    v("rejected", rejected);
    v("above", above);
    v("smallest", smallest);
    v("largest", largest);
    v("error_sum", error_sum);
    v("largest_error", largest_error);
    v("worst", worst);
  }
};

}  // namespace mebots::master
