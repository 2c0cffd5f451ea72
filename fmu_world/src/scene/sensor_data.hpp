// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

/// Data of sensors from a drone's file, in SI units.
namespace mebots::world::scene {

/// A time-of-flight sensor with a field of view. It measures the distance to the nearest surface in its cone every
/// `period`. Standard deviation: near_noise (1 + (far_noise / near_noise)^((d - near) / (far - near))).
struct RangeData {
  double field_of_view_rad = 0.0;  ///< angle of the whole cone
  double period_s = 0.0;
  double resolution_m = 0.0;
  double near_m = 0.0;
  double near_noise_m = 0.0;
  double far_m = 0.0;
  double far_noise_m = 0.0;
};

/// An optical flow sensor. In each period, it measures the motion of its picture of the surface below.
struct FlowData {
  double pixels_per_rad = 0.0;  ///< of motion in the middle of the picture
  double period_s = 0.0;
  double resolution_pixels = 0.0;  ///< one count
  double noise_pixels = 0.0;       ///< standard deviation of a sample
  double nearest_m = 0.0;          ///< nearer surfaces are invisible
  double fastest_rad_per_s = 0.0;  ///< faster motion is invisible
};

/// Range sensors to the front, back, left, right and up. Their field of view, noise and resolution are those of
/// RangeData.
struct MultirangerData {
  Eigen::Vector3d offset_m = Eigen::Vector3d::Zero();  ///< half the distances between opposite sensors, along the axes
  double period_s = 0.0;
  double power_w = 0.0;  ///< of all five
};

/// A pressure sensor. Its bias is constant and is drawn from the seed.
struct BarometerData {
  double period_s = 0.0;
  double resolution_pa = 0.0;
  double noise_pa = 0.0;  ///< standard deviation of a sample
  double bias_pa = 0.0;   ///< standard deviation of the bias
  double power_w = 0.0;
};

/// A magnetometer with three axes. Its bias is constant and is drawn from the seed.
struct MagnetometerData {
  double period_s = 0.0;
  double limit_t = 0.0;  ///< greatest magnitude along an axis
  double resolution_t = 0.0;
  Eigen::Vector3d noise_t = Eigen::Vector3d::Zero();  ///< standard deviation of a sample
  double bias_t = 0.0;                                ///< standard deviation of the bias of each axis
  double power_w = 0.0;
};

}  // namespace mebots::world::scene
