// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/renderer.hpp"
#include "scene/scene.hpp"

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

namespace mebots::world::camera::testing {

inline scene::Texture uniform(double grey) {
  scene::Texture texture;
  texture.kind = scene::Texture::Kind::uniform;
  texture.light = grey;
  return texture;
}

inline scene::Texture patterned(scene::Texture::Kind kind, double light, double dark, double scale_m) {
  scene::Texture texture;
  texture.kind = kind;
  texture.light = light;
  texture.dark = dark;
  texture.scale_m = scale_m;
  texture.seed = 7;
  return texture;
}

/// Returns a scene with black ground and background, and white light from all directions.
inline scene::Scene dark_scene() {
  scene::Scene scene;
  scene.ground.texture = uniform(0.0);
  scene.lighting.ambient = 1.0;
  scene.lighting.sun = 0.0;
  scene.lighting.background = 0.0;
  return scene;
}

/// Returns a room with three walls, a pillar across a corner of the view, and two gates. Each object has a different
/// grey level.
inline scene::Scene room() {
  scene::Scene scene;
  scene.ground.texture = uniform(90.0);
  scene.ground.half_size_m = 8.0;
  scene.lighting.ambient = 0.4;
  scene.lighting.sun = 0.5;
  scene.lighting.to_sun_W = Eigen::Vector3d(-0.6, 0.3, 0.74).normalized();
  scene.lighting.background = 240.0;
  scene.boxes = {
      {"east", {8.0, 0.0, 1.5}, {0.2, 10.0, 3.0}, 0.0, uniform(150.0)},
      {"north", {2.0, 4.0, 1.5}, {12.0, 0.2, 3.0}, 0.1, uniform(170.0)},
      {"west", {-3.0, 0.0, 1.0}, {0.3, 10.0, 2.0}, -0.2, uniform(130.0)},
      {"pillar", {3.0, -1.2, 1.0}, {0.4, 0.3, 2.0}, 0.7, uniform(110.0)},
      {"shelf", {2.0, 1.8, 1.4}, {1.0, 0.3, 0.05}, 0.4, uniform(190.0)},
  };
  scene::Gate gate;
  gate.name = "first";
  gate.p_W_m = {4.0, 0.2, 1.03};
  gate.yaw_rad = 0.2;
  gate.texture = uniform(250.0);
  scene.gates.push_back(gate);
  gate.name = "second";
  gate.p_W_m = {6.0, -0.8, 1.4};
  gate.yaw_rad = -0.6;
  gate.texture = uniform(220.0);
  scene.gates.push_back(gate);
  return scene;
}

inline scene::Scene patterned_room() {
  using Kind = scene::Texture::Kind;
  scene::Scene scene = room();
  scene.ground.texture = patterned(Kind::checker, 130.0, 90.0, 0.5);
  scene.boxes[0].texture = patterned(Kind::bricks, 170.0, 120.0, 0.2);
  scene.boxes[1].texture = patterned(Kind::noise, 180.0, 60.0, 0.4);
  scene.boxes[2].texture = patterned(Kind::stripes, 150.0, 100.0, 0.3);
  scene.gates[0].texture = patterned(Kind::checker, 250.0, 200.0, 0.05);
  return scene;
}

inline Pose pose(const Eigen::Vector3d& p_WC_m, double yaw_rad = 0.0, double pitch_rad = 0.0, double roll_rad = 0.0) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  return {p_WC_m, (AngleAxisd(yaw_rad, Vector3d::UnitZ()) * AngleAxisd(pitch_rad, Vector3d::UnitY()) *
                   AngleAxisd(roll_rad, Vector3d::UnitX()))
                      .toRotationMatrix()};
}

/// Returns poses that are likely to reveal errors: in a gate's opening, on the ground, against a wall, above, upside
/// down.
inline std::vector<Pose> awkward_poses() {
  return {
      pose({0.0, 0.0, 1.0}),
      pose({4.0, 0.2, 1.03}, 0.2),              // in the centre of the first gate
      pose({3.99, 0.39, 1.2}, 1.2, 0.3, 0.4),   // in its corner
      pose({4.02, 0.2, 0.831}, 0.25, -0.2),     // a millimetre above its lower edge
      pose({0.0, 0.0, 0.0265}, 0.1),            // standing on the ground
      pose({1.0, 0.5, 0.001}, 0.5, -0.1, 0.1),  // a millimetre above it
      pose({7.895, 0.3, 1.5}, 0.6, 0.05),       // 5 mm before the east wall
      pose({2.0, 0.0, 2.5}, 0.4, 1.5),          // looking down
      pose({2.0, 0.0, 1.2}, 2.8, -0.4, 3.0),    // upside down
      pose({4.5, 0.0, 1.1}, 3.3, 0.0, -0.5),    // looking back through the first gate
      pose({2.0, 1.6, 1.4}, 0.4),               // at the height of the shelf
  };
}

struct Picture {
  int width;
  std::vector<std::uint8_t> pixels;
  int at(int column, int row) const { return pixels[static_cast<std::size_t>(row) * width + column]; }
  bool operator==(const Picture&) const = default;
};

inline Picture picture(Renderer& renderer, const Pose& from, std::uint64_t seed = 1, std::uint64_t frame = 0) {
  const Intrinsics& size = renderer.intrinsics();
  Picture result{size.width, std::vector<std::uint8_t>(static_cast<std::size_t>(size.width) * size.height, 77)};
  renderer.render(from, seed, frame, result.pixels);
  return result;
}

inline int differing_pixels(const Picture& a, const Picture& b) {
  int count = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) count += a.pixels[i] != b.pixels[i] ? 1 : 0;
  return count;
}

/// Returns column and row of a point of the world in the picture. The point must be in front of the camera.
inline Eigen::Vector2d projected(const Eigen::Vector3d& p_W_m, const Pose& from, const Intrinsics& intrinsics) {
  const Eigen::Vector3d p_C = from.R_WC.transpose() * (p_W_m - from.p_WC_m);
  const double f = 0.5 * intrinsics.width / std::tan(0.5 * intrinsics.horizontal_field_of_view_rad);
  return {0.5 * intrinsics.width - f * p_C.y() / p_C.x(), 0.5 * intrinsics.height - f * p_C.z() / p_C.x()};
}

}  // namespace mebots::world::camera::testing
