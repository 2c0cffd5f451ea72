// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"

#include <Eigen/Geometry>

/// Converts Eigen's types to spans of numbers for state::Visitor.
namespace mebots::world {

inline std::span<double, 3> numbers(Eigen::Vector3d& v) {
  return std::span<double, 3>(v.data(), 3);
}

/// The order of the numbers is x, y, z, w.
inline std::span<double, 4> numbers(Eigen::Quaterniond& q) {
  return std::span<double, 4>(q.coeffs().data(), 4);
}

}  // namespace mebots::world
