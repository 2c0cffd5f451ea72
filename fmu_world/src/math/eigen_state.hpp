// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/bytes.hpp"

#include <Eigen/Geometry>

/// Eigen's types as saved state: their numbers, one by one.
namespace mebots::world {

inline void put(state::Writer& writer, const Eigen::Vector3d& v) {
  for (int i = 0; i < 3; ++i) writer.put(v[i]);
}

inline void get(state::Reader& reader, Eigen::Vector3d& v) {
  for (int i = 0; i < 3; ++i) reader.get(v[i]);
}

inline void put(state::Writer& writer, const Eigen::Quaterniond& q) {
  for (int i = 0; i < 4; ++i) writer.put(q.coeffs()[i]);
}

inline void get(state::Reader& reader, Eigen::Quaterniond& q) {
  for (int i = 0; i < 4; ++i) reader.get(q.coeffs()[i]);
}

}  // namespace mebots::world
