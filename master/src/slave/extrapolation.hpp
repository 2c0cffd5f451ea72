// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

namespace mebots::master {

/// Returns a value after a time, by its derivatives of orders 1 and up: its Taylor polynomial.
inline double extrapolated(double value, std::span<const double> derivatives, double since_s) {
  double sum = 0;
  for (auto order = derivatives.size(); order > 0; --order) {
    sum = (sum + derivatives[order - 1]) * since_s / static_cast<double>(order);
  }
  return value + sum;
}

}  // namespace mebots::master
