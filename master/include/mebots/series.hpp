// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace mebots {

/// One recorded variable, with a value for every entry of Mission::times(); Booleans as 0 and 1.
struct Series {
  std::string name;  ///< instance.variable
  std::string unit;  ///< empty = none
  std::vector<double> values;
};

}  // namespace mebots
