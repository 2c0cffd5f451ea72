// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/data/object.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mebots::data {

/// A quantity of a data file with the interval that the data allow.
struct Estimate {
  struct Interval {
    double least = 0;
    double most = 0;
  };

  double value = 0;
  std::optional<Interval> interval;  // contains the value

  /// Returns the value at a position in the interval: -1 is the lower end, 0 the value, 1 the upper end. Between these
  /// positions, the result is linear. If there is no interval, returns the value.
  double at(double position) const;
};

/// Reads an object with the keys "value", "unit" and "source", and checks the unit. The keys "interval" ([low, high])
/// and "fitted_on" are optional.
Estimate read_estimate(const Node& node, std::string_view unit, const Limits& limits);
inline auto estimate(std::string_view unit, const Limits& limits = {}) {
  return [=](const Node& node) { return read_estimate(node, unit, limits); };
}

/// Computes the values of a data file's quantities at positions in their intervals.
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
