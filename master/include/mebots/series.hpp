// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace mebots {

/// The values of a recorded variable, one for each time in Mission::times(). Booleans are stored as 0 and 1.
struct Series {
  std::string name;  ///< instance.variable
  std::string unit;  ///< empty if the variable has no unit
  std::vector<double> values;
};

}  // namespace mebots
