// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/pose.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace mebots::world::camera {

/// What a lens does to a picture.
struct LensSettings {
  /// Radial distortion after Brown: a ray at r = tan(angle to the axis) meets the sensor at r (1 + k1 r^2 + k2 r^4),
  /// both in focal lengths. Negative k1 is a barrel.
  double k1 = 0.0;
  double k2 = 0.0;
  /// How much of the cos^4 law of illumination is there: 0 none, 1 all of it, more for a lens that shades its corners.
  double vignetting = 0.0;

  bool distorts() const { return k1 != 0.0 || k2 != 0.0; }
  bool is_neutral() const { return !distorts() && vignetting == 0.0; }
};

/// Bends a pinhole's picture and darkens its corners, by tables made once.
class Lens {
 public:
  /// For a picture of `intrinsics`, whose field of view is that without distortion. Throws mebots::Error where a ray
  /// cannot be told from the place at which it meets the sensor, or would come from too far aside.
  Lens(const Intrinsics& intrinsics, const LensSettings& settings);

  /// The pinhole's picture to render: of the same focal length, as large as the lens looks aside.
  const Intrinsics& pinhole() const { return pinhole_; }

  /// From a pinhole's light to that on the sensor, row by row from the top left; multiplied by `factor`.
  void project(std::span<const float> light, float factor, std::span<float> sensor) const;

 private:
  struct Look {
    std::int32_t place;  // of the upper left of four pixels
    float right, down;   // shares of the way to the next
  };

  Intrinsics intrinsics_;
  Intrinsics pinhole_;
  std::vector<Look> looks_;  // none without distortion
  std::vector<float> shade_;
};

}  // namespace mebots::world::camera
