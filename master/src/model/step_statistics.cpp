// SPDX-License-Identifier: Apache-2.0
#include "model/step_statistics.hpp"

#include <algorithm>

namespace mebots::master {

void StepStatistics::add(std::int64_t length, double error) {
  smallest = steps == 0 ? length : std::min(smallest, length);
  largest = std::max(largest, length);
  ++steps;
  if (error > 1) ++above;
  error_sum += error;
  largest_error = std::max(largest_error, error);
}

}  // namespace mebots::master
