// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/data/object.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mebots::data {

/// A quantity of a data file. `interval` is the range of values that the data permit.
struct Estimate {
  struct Interval {
    double least = 0;
    double most = 0;
  };

  double value = 0;
  std::optional<Interval> interval;  // contains the value, if it exists

  /// Returns the value at a position in the interval: the lower end at -1, the value at 0, the upper end at 1. Between
  /// these positions, interpolates linearly. If the interval is missing, returns the value.
  double at(double position) const;
};

/// Reads an object with the keys "value", "unit" and "source", and checks the unit. The keys "interval" ([low, high])
/// and "fitted_on" are optional.
Estimate read_estimate(const Node& node, std::string_view unit, const Limits& limits);
inline auto estimate(std::string_view unit, const Limits& limits = {}) {
  return [=](const Node& node) { return read_estimate(node, unit, limits); };
}

/// Reads quantities of a data file at positions in their intervals: -1 is the lower end, 0 the value, 1 the upper end.
class Placement {
 public:
  /// `file` is the file's name in warnings. value() appends the warnings to `warnings`.
  Placement(std::string file, std::vector<std::string>& warnings) : file_(std::move(file)), warnings_(&warnings) {}

  /// Returns estimate.at(position). If the position is outside of -1 to 1, throws Error that names `parameter`. If the
  /// position is not 0 but the file has no interval, appends a warning.
  double value(const Estimate& estimate, double position, std::string_view quantity, std::string_view parameter) const;

 private:
  std::string file_;
  std::vector<std::string>* warnings_;
};

}  // namespace mebots::data
