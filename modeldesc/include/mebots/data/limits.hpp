// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>
#include <string>

namespace mebots::data {

/// The permitted range of a number. The default permits every finite number.
struct Limits {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool min_is_allowed = true;

  static Limits positive() { return {0, std::numeric_limits<double>::infinity(), false}; }
  static Limits at_least(double least) { return {least, std::numeric_limits<double>::infinity(), true}; }
  static Limits between(double least, double most) { return {least, most, true}; }

  bool admit(double value) const {
    return std::isfinite(value) && value <= max && (min_is_allowed ? value >= min : value > min);
  }
  /// Returns the range as text, such as ">= 0 and <= 1".
  std::string text() const;
};

}  // namespace mebots::data
