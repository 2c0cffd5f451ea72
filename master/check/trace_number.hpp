// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/error.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <string_view>
#include <type_traits>

namespace mebots::check {

/// Converts a finite number to the type T. Rounds to Float32. Throws Error if the type cannot represent the number; the
/// text contains `variable`, such as "Int32 x".
template <typename T>
T converted(double value, std::string_view variable) {
  using Limits = std::numeric_limits<T>;
  bool fits = false;
  if constexpr (std::is_floating_point_v<T>) {
    fits = std::abs(value) <= static_cast<double>(Limits::max());
  } else {
    // A double may not represent the largest integer exactly.
    const double end = std::ldexp(1.0, Limits::digits);
    fits = std::trunc(value) == value && value < end && value >= (Limits::is_signed ? -end : 0);
  }
  if (fits) return static_cast<T>(value);
  throw Error(ErrorCode::syntax_error, fmt::format("the trace has {} for the {}", value, variable));
}

}  // namespace mebots::check
