// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/data/object.hpp"

#include <fmt/format.h>
#include <Eigen/Core>

namespace mebots::world::scene {

/// Reads a list of `Size` numbers within limits.
template <int Size>
auto vector(const data::Limits& limits = {}) {
  return [limits](const data::Node& node) {
    const auto values = data::read_numbers(node, limits);
    if (node.elements().size() != Size) {
      node.fail(ErrorCode::invalid_value,
                fmt::format("{} numbers are needed here, not {}", Size, node.elements().size()));
    }
    Eigen::Matrix<double, Size, 1> vector = Eigen::Matrix<double, Size, 1>::Zero();
    if (values.size() == Size) vector = Eigen::Matrix<double, Size, 1>(values.data());
    return vector;
  };
}

}  // namespace mebots::world::scene
