// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace mebots::world {

/// Returns the multiple of `resolution` that is nearest to a value. If the resolution is 0, returns the value.
inline double rounded(double value, double resolution) {
  return resolution > 0.0 ? resolution * std::round(value / resolution) : value;
}

}  // namespace mebots::world
