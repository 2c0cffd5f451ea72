// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <array>

/// Conversions between the arrays of an FMU's variables and vectors.
namespace mebots::world {

inline Eigen::Vector3d to_vector(const std::array<double, 3>& v) {
  return {v[0], v[1], v[2]};
}

inline std::array<double, 3> to_array(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

}  // namespace mebots::world
