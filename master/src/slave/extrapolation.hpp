// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

namespace mebots::master {

/// Evaluates a Taylor polynomial `since_s` seconds after its centre. `value` is its value at the centre. `derivatives`
/// contains its derivatives at the centre, from order 1.
inline double extrapolated(double value, std::span<const double> derivatives, double since_s) {
  double sum = 0;
  for (auto order = derivatives.size(); order > 0; --order) {
    sum = (sum + derivatives[order - 1]) * since_s / static_cast<double>(order);
  }
  return value + sum;
}

}  // namespace mebots::master
