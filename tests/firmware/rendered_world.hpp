// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/lens.hpp"
#include "camera/renderer.hpp"
#include "scene/load.hpp"
#include "scene/scene.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace mebots::firmware_test {

inline constexpr double kDegree = M_PI / 180.0;

/// Generates uniform random numbers that are the same on every machine. Those of std::uniform_real_distribution differ.
class Uniform {
 public:
  explicit Uniform(std::uint64_t seed) : bits_(seed) {}
  double operator()(double low, double high) {
    return low + (high - low) * static_cast<double>(bits_() >> 11) * 0x1p-53;
  }

 private:
  std::mt19937_64 bits_;
};

inline world::scene::Scene load_scene(const std::string& name) {
  return world::scene::load_scene(std::string(MEBOTS_SOURCE_DIR) + "/fmu_world/params/scenes/" + name + ".json");
}

/// The pose of the drone: position of its centre, then yaw (positive to the left), pitch (positive nose down), roll.
struct BodyPose {
  Eigen::Vector3d p_WB_m = Eigen::Vector3d::Zero();
  double yaw_rad = 0.0;
  double pitch_rad = 0.0;
  double roll_rad = 0.0;
};

inline Eigen::Matrix3d rotation(const BodyPose& pose) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  return (AngleAxisd(pose.yaw_rad, Vector3d::UnitZ()) * AngleAxisd(pose.pitch_rad, Vector3d::UnitY()) *
          AngleAxisd(pose.roll_rad, Vector3d::UnitX()))
      .toRotationMatrix();
}

/// The drone's camera as in fmu_world: 320 x 320, 1.51844 rad, noise of two grey levels.
class Camera {
 public:
  explicit Camera(const world::scene::Scene& scene, double noise_std = 2.0, int width = 320, int height = 320)
      : renderer_(scene, {width, height, 1.51844}, noise_std), pixels_(static_cast<std::size_t>(width) * height) {}

  const std::vector<std::uint8_t>& take(const BodyPose& pose, std::uint64_t seed) {
    renderer_.render(world::camera::camera_pose({}, pose.p_WB_m, rotation(pose)), seed, ++count_, pixels_);
    return pixels_;
  }
  int width() const { return renderer_.intrinsics().width; }
  int height() const { return renderer_.intrinsics().height; }
  double focal_length_px() const { return renderer_.intrinsics().focal_length_px(); }

 private:
  world::camera::Renderer renderer_;
  std::vector<std::uint8_t> pixels_;
  std::uint64_t count_ = 0;
};

/// A point of the world in the camera's picture: its pixel, counted from the top left, and its distance along the
/// optical axis.
struct Projection {
  double x_px;
  double y_px;
  double depth_m;
};

inline Projection project(const Camera& camera, const BodyPose& pose, const Eigen::Vector3d& p_W_m) {
  const auto view = world::camera::camera_pose({}, pose.p_WB_m, rotation(pose));
  const Eigen::Vector3d p_C_m = view.R_WC.transpose() * (p_W_m - view.p_WC_m);
  return {0.5 * camera.width() - camera.focal_length_px() * p_C_m.y() / p_C_m.x(),
          0.5 * camera.height() - camera.focal_length_px() * p_C_m.z() / p_C_m.x(), p_C_m.x()};
}

}  // namespace mebots::firmware_test
