// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

namespace mebots::data {
class Node;
}

namespace mebots::battery {

/// Computes a quantity from the state of charge s in [0, 1]. The quantity has one of two forms:
///   a exp(-b s) + c0 + c1 s + c2 s^2 + c3 s^3   (the form of Chen and Rincon-Mora 2006)
///   a table, linear between its points
class Curve {
 public:
  /// Reads {"unit", "exponential": [a, b], "polynomial": [c0, ...]} or {"unit", "state_of_charge", "value"}. The state
  /// of charge must rise from 0 to 1. The file's unit must be `unit`. Records mistakes in the node's document.
  static Curve read(const data::Node& node, std::string_view unit);

  static Curve analytic(double factor, double rate, std::vector<double> polynomial);

  /// Returns the value at s. The caller must keep s within [0, 1]. Only trial points of an integrator may be slightly
  /// outside.
  double operator()(double s) const;

  Curve scaled(double factor) const;

 private:
  double factor_ = 0;
  double rate_ = 0;
  double polynomial_[4] = {0, 0, 0, 0};
  std::vector<double> table_s_;  // empty for the analytic form
  std::vector<double> table_value_;
};

}  // namespace mebots::battery
