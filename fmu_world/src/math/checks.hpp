// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/error.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string_view>

/// Checks of parameters and inputs. All functions throw mebots::Error with the name of the variable.
namespace mebots::world {

/// Throws Error if the value is not finite. The variable's name in the message is `name` + `part`.
inline void require_finite(double value, std::string_view name, std::string_view part = "") {
  if (!std::isfinite(value)) throw Error(fmt::format("{}{} = {} must be a finite number", name, part, value));
}

inline void require_at_least_zero(double value, std::string_view name, std::string_view part = "") {
  require_finite(value, name, part);
  if (value < 0.0) throw Error(fmt::format("{}{} = {} must be at least 0", name, part, value));
}

inline double checked(double value, double least, double most, std::string_view name) {
  if (!(value >= least && value <= most))
    throw Error(fmt::format("{} = {} must be from {} to {}", name, value, least, most));
  return value;
}

}  // namespace mebots::world
