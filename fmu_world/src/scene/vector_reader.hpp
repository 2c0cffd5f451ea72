// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/data/estimate.hpp"
#include "mebots/data/object.hpp"

#include <fmt/format.h>
#include <Eigen/Core>
#include <string_view>

namespace mebots::world::scene {

/// Returns a reader of `Size` numbers within limits.
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

/// Returns a reader of {"values": [x, y, z], "unit": text, "source": text}.
inline auto sourced_vector(std::string_view unit, const data::Limits& limits) {
  return [=](const data::Node& node) {
    data::Object object(node);
    Eigen::Vector3d values = Eigen::Vector3d::Zero();
    object.read("values", values, vector<3>(limits));
    data::read_unit(object, unit);
    data::read_source(object);
    object.comment("fitted_on");
    object.finish();
    return values;
  };
}

}  // namespace mebots::world::scene
