// SPDX-License-Identifier: Apache-2.0
#include "camera/lens.hpp"

#include "mebots/assert.hpp"
#include "mebots/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace mebots::world::camera {
namespace {

/// The tangent of the greatest permitted angle between a ray and the axis, 80 degrees.
constexpr double kFarthestAside = 5.67;

/// Returns the tangent of the angle of the ray that meets the sensor at `at`: the least root of r (1 + k1 r^2 + k2 r^4)
/// = at, by Newton's method from 0. The iterates rise to the root while the slope is positive.
double undistorted(const LensSettings& settings, double at) {
  double r = 0.0;
  for (int i = 0; i < 60; ++i) {
    const double square = r * r;
    const double slope = 1.0 + square * (3.0 * settings.k1 + 5.0 * settings.k2 * square);
    if (!(slope > 0.05)) break;
    const double miss = at - r * (1.0 + square * (settings.k1 + settings.k2 * square));
    if (std::abs(miss) < 1e-12) return r;
    r += miss / slope;
    if (!(r >= 0.0 && r < kFarthestAside)) break;
  }
  throw Error(
      fmt::format("camera.distortion: with k1 = {} and k2 = {} no ray is found that meets the sensor {:.3f} focal "
                  "lengths from its middle; smaller coefficients, or a smaller camera.field_of_view, are needed",
                  settings.k1, settings.k2, at));
}

}  // namespace

Lens::Lens(const Intrinsics& intrinsics, const LensSettings& settings) : intrinsics_(intrinsics), pinhole_(intrinsics) {
  if (!std::isfinite(settings.k1) || !std::isfinite(settings.k2)) {
    throw Error(fmt::format("camera.distortion: k1 = {} and k2 = {} must be finite numbers", settings.k1, settings.k2));
  }
  if (!(settings.vignetting >= 0.0 && settings.vignetting <= 4.0)) {
    throw Error(fmt::format("camera.vignetting = {} must be from 0 to 4", settings.vignetting));
  }
  const int width = intrinsics.width;
  const int height = intrinsics.height;
  const double f = intrinsics.focal_length_px();
  const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  std::vector<double> stretch(pixels,
                              1.0);  // factor of the distance from the middle, from the sensor to the pinhole's picture
  shade_.resize(pixels);
  double widest_px = 0.5 * width;
  double highest_px = 0.5 * height;
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const std::size_t i = static_cast<std::size_t>(row) * width + column;
      const double x = column + 0.5 - 0.5 * width;
      const double y = row + 0.5 - 0.5 * height;
      const double at = std::sqrt(x * x + y * y) / f;
      const double r = settings.distorts() ? undistorted(settings, at) : at;
      if (at > 0.0) stretch[i] = r / at;
      const double cos_squared = 1.0 / (1.0 + r * r);
      shade_[i] = static_cast<float>(std::max(0.0, 1.0 - settings.vignetting * (1.0 - cos_squared * cos_squared)));
      widest_px = std::max(widest_px, std::abs(x) * stretch[i] + 1.0);
      highest_px = std::max(highest_px, std::abs(y) * stretch[i] + 1.0);
    }
  }
  if (!settings.distorts()) return;
  constexpr int kMost_px = 2048;
  pinhole_.width = 2 * static_cast<int>(std::ceil(widest_px));
  pinhole_.height = 2 * static_cast<int>(std::ceil(highest_px));
  if (pinhole_.width > kMost_px || pinhole_.height > kMost_px) {
    throw Error(
        fmt::format("camera.distortion: k1 = {} and k2 = {} need a picture of {} x {} pixels behind the lens; at "
                    "most {} x {} are possible",
                    settings.k1, settings.k2, pinhole_.width, pinhole_.height, kMost_px, kMost_px));
  }
  pinhole_.horizontal_field_of_view_rad = 2.0 * std::atan(0.5 * pinhole_.width / f);
  looks_.resize(pixels);
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const std::size_t i = static_cast<std::size_t>(row) * width + column;
      const double x = std::clamp((column + 0.5 - 0.5 * width) * stretch[i] + 0.5 * pinhole_.width - 0.5, 0.0,
                                  pinhole_.width - 1.001);
      const double y = std::clamp((row + 0.5 - 0.5 * height) * stretch[i] + 0.5 * pinhole_.height - 0.5, 0.0,
                                  pinhole_.height - 1.001);
      const int left = static_cast<int>(x);
      const int top = static_cast<int>(y);
      looks_[i] = {top * pinhole_.width + left, static_cast<float>(x - left), static_cast<float>(y - top)};
    }
  }
}

void Lens::project(std::span<const float> light, float factor, std::span<float> sensor) const {
  MEBOTS_ASSERT(sensor.size() == shade_.size());
  MEBOTS_ASSERT(light.size() == static_cast<std::size_t>(pinhole_.width) * static_cast<std::size_t>(pinhole_.height));
  if (looks_.empty()) {
    for (std::size_t i = 0; i < sensor.size(); ++i) sensor[i] = light[i] * (factor * shade_[i]);
    return;
  }
  const float* const from = light.data();
  const int next_row = pinhole_.width;
  for (std::size_t i = 0; i < sensor.size(); ++i) {
    const Look& look = looks_[i];
    const float* const four = from + look.place;
    const float upper = four[0] + look.right * (four[1] - four[0]);
    const float lower = four[next_row] + look.right * (four[next_row + 1] - four[next_row]);
    sensor[i] = (upper + look.down * (lower - upper)) * (factor * shade_[i]);
  }
}

double Intrinsics::focal_length_px() const {
  return 0.5 * width / std::tan(0.5 * horizontal_field_of_view_rad);
}

Pose camera_pose(const Mounting& mounting, const Eigen::Vector3d& p_WB_m, const Eigen::Matrix3d& R_WB) {
  const double c = std::cos(mounting.pitch_rad);
  const double s = std::sin(mounting.pitch_rad);
  Eigen::Matrix3d R_BC;
  R_BC << c, 0.0, s,  //
      0.0, 1.0, 0.0,  //
      -s, 0.0, c;
  return Pose{p_WB_m + R_WB * mounting.p_BC_m, R_WB * R_BC, 0};
}

}  // namespace mebots::world::camera
