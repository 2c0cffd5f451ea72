// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace mebots::world::camera {

/// A pinhole camera with square pixels. The optical axis passes through the middle of the picture.
struct Intrinsics {
  int width = 320;                                ///< pixels, 8..2048
  int height = 320;                               ///< pixels, 8..2048
  double horizontal_field_of_view_rad = 1.51844;  ///< full angle over the width, 0.1..3.0

  /// Returns the focal length in pixels: (width / 2) / tan(half the field of view).
  double focal_length_px() const;
};

struct BodyPose {
  Eigen::Vector3d p_WB_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d R_WB = Eigen::Matrix3d::Identity();
};

/// The pose of the camera. Axes of its frame C: x forward along the optical axis, y left, z up. A point (x, y, z) in C
/// with x > 0 appears at column width/2 - f y/x and row height/2 - f z/x, counted from the picture's top left corner.
/// The centre of the top left pixel is (0.5, 0.5).
struct Pose {
  Eigen::Vector3d p_WC_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d R_WC = Eigen::Matrix3d::Identity();
  std::int64_t time_ns = 0;               ///< time of the positions of moving things
  std::span<const BodyPose> bodies = {};  ///< of all drones, then all robots, at this time
  std::size_t own_body = 0;               ///< index of the camera's own drone, which it does not see
};

/// Position and pitch of the camera in the drone's body.
struct Mounting {
  Eigen::Vector3d p_BC_m{0.027, 0.0, 0.012};
  double pitch_rad = 0.0;  ///< about the body's y, positive looks down
};

Pose camera_pose(const Mounting& mounting, const Eigen::Vector3d& p_WB_m, const Eigen::Matrix3d& R_WB);

/// Optical properties of a lens.
struct LensSettings {
  /// Radial distortion by Brown's model: a ray at r = tan(angle to the axis) meets the sensor at r (1 + k1 r^2 + k2
  /// r^4), where r is in focal lengths. A negative k1 gives a barrel distortion.
  double k1 = 0.0;
  double k2 = 0.0;
  /// Share of the cos^4 law of illumination: 0 means no vignetting, 1 means the full law. A value above 1 darkens the
  /// corners more than the law.
  double vignetting = 0.0;

  bool distorts() const { return k1 != 0.0 || k2 != 0.0; }
  bool is_neutral() const { return !distorts() && vignetting == 0.0; }
};

/// Distorts a pinhole's picture and darkens its corners. Uses precomputed tables.
class Lens {
 public:
  /// Computes the tables. The field of view of `intrinsics` is that of the lens without distortion. Throws
  /// mebots::Error if a setting is out of range, if no ray within 80 degrees of the axis is found for a pixel of the
  /// sensor, or if the undistorted picture would be too large.
  Lens(const Intrinsics& intrinsics, const LensSettings& settings);

  /// Returns the intrinsics of the undistorted picture that must be rendered: the lens's focal length, and a size that
  /// covers the rays of all sensor pixels.
  const Intrinsics& pinhole() const { return pinhole_; }

  /// The pixel of the undistorted picture that is nearest to a sensor pixel's ray. `right` and `down` are the distances
  /// of the ray from the centre of this pixel, in pixels.
  struct Source {
    std::size_t pixel;
    double right, down;
  };
  Source source(std::size_t sensor_pixel) const {
    if (looks_.empty()) return {sensor_pixel, 0.0, 0.0};
    const Look& look = looks_[sensor_pixel];
    const int right = look.right >= 0.5F ? 1 : 0;
    const int down = look.down >= 0.5F ? 1 : 0;
    return {static_cast<std::size_t>(look.place + right + down * pinhole_.width), look.right - right, look.down - down};
  }

  /// Computes the light on the sensor: the light of the undistorted picture, projected and multiplied by `factor`. Both
  /// pictures are row by row from the top left.
  void project(std::span<const float> light, float factor, std::span<float> sensor) const;

 private:
  struct Look {
    std::int32_t place;  // index of the upper left of four pixels
    float right, down;   // weights of the next pixels
  };

  Intrinsics intrinsics_;
  Intrinsics pinhole_;
  std::vector<Look> looks_;  // empty without distortion
  std::vector<float> shade_;
};

}  // namespace mebots::world::camera
