// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/data/object.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mebots::data {

/// Contains a quantity of a data file, and the interval in which the data allow the quantity to be.
struct Estimate {
  struct Interval {
    double least = 0;
    double most = 0;
  };

  double value = 0;
  std::optional<Interval> interval;  // contains the value, if it exists

  /// Returns the value at a position in the interval: the lower end at -1, the value at 0, the upper end at 1.
  /// Interpolates linearly between these positions. If there is no interval, returns the value.
  double at(double position) const;
};

/// Reads an object with the keys "value", "unit" and "source", and checks the unit. The keys "interval" ([low, high])
/// and "fitted_on" are optional.
Estimate read_estimate(const Node& node, std::string_view unit, const Limits& limits);
inline auto estimate(std::string_view unit, const Limits& limits = {}) {
  return [=](const Node& node) { return read_estimate(node, unit, limits); };
}

/// Computes quantities of a data file, each at a position in its interval.
class Placement {
 public:
  /// `file` names the file in warnings, which are appended to `warnings`.
  Placement(std::string file, std::vector<std::string>& warnings) : file_(std::move(file)), warnings_(&warnings) {}

  /// Returns estimate.at(position). If the position is not from -1 to 1, throws Error that names `parameter`. Appends a
  /// warning if the position is not 0 and the file has no interval.
  double value(const Estimate& estimate, double position, std::string_view quantity, std::string_view parameter) const;

 private:
  std::string file_;
  std::vector<std::string>* warnings_;
};

}  // namespace mebots::data
