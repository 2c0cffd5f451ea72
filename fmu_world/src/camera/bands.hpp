// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/lens.hpp"

#include <algorithm>
#include <functional>

namespace mebots::world::camera {

/// Returns the camera's pose `after_s` seconds after the start of the picture.
using PoseAt = std::function<Pose(double after_s)>;

/// Calls act(first_row, end_row, after_s) for each band of rows. All rows of a band are rendered for the same time.
/// `pinhole` describes the undistorted picture, which has more rows than the sensor, because a lens also bends light
/// from above and below into the picture.
template <typename Act>
void for_each_band(const Intrinsics& pinhole, const Intrinsics& sensor, double line_time_s, Act&& act) {
  constexpr int kBandRows = 8;  // at 63 us per row, half a millisecond
  if (line_time_s == 0.0) {
    act(0, pinhole.height, 0.0);
    return;
  }
  const double first_row = 0.5 * (pinhole.height - sensor.height);
  for (int row = 0; row < pinhole.height; row += kBandRows) {
    const int end = std::min(row + kBandRows, pinhole.height);
    const double middle = std::clamp(0.5 * (row + end - 1) - first_row, 0.0, sensor.height - 1.0);
    act(row, end, line_time_s * middle);
  }
}

}  // namespace mebots::world::camera
