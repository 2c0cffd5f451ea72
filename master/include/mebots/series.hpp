// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace mebots {

/// The values of a recorded variable, one per entry of Mission::times(). Booleans are 0 and 1.
struct Series {
  std::string name;  ///< instance.variable
  std::string unit;  ///< empty = none
  std::vector<double> values;
};

}  // namespace mebots
