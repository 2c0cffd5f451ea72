// SPDX-License-Identifier: Apache-2.0
// Tests the gate finder on pictures of the real renderer, from random poses with a fixed seed.

#include "app/gate_finder.h"
#include "app/navigator.h"

#include "rendered_world.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

namespace mebots::firmware_test {
namespace {

struct Statistics {
  int pictures = 0;
  int found = 0;  ///< with a bearing within 3 degrees of the truth
  int wrong = 0;  ///< found something else
  std::vector<double> bearing_errors_rad;
  std::vector<double> distance_errors;  ///< relative

  void add(const Camera& camera, const Projection& truth, bool seen, const gate_view_t& view) {
    ++pictures;
    if (!seen) return;
    const double focal_px = camera.focal_length_px();
    const double middle_px = 0.5 * camera.width();
    const double bearing_error =
        std::atan2(middle_px - view.center_x_q4 / 16.0, focal_px) - std::atan2(middle_px - truth.x_px, focal_px);
    if (std::abs(bearing_error) > 3.0 * kDegree) {
      ++wrong;
      return;
    }
    ++found;
    bearing_errors_rad.push_back(std::abs(bearing_error));
    distance_errors.push_back(std::abs(focal_px * 0.6 / (view.height_q4 / 16.0) / truth.depth_m - 1.0));
  }
  double rate() const { return static_cast<double>(found) / pictures; }
  static double quantile(std::vector<double> values, double q) {
    if (values.empty()) return NAN;
    std::sort(values.begin(), values.end());
    return values[static_cast<std::size_t>(q * (static_cast<double>(values.size()) - 1))];
  }
  void print(const std::string& what) const {
    std::printf(
        "[ measured ] %s: %d pictures, found %.1f %%, wrong %.1f %%, bearing error median %.2f deg, "
        "95 %% below %.2f deg, distance error median %.1f %%, 95 %% below %.1f %%\n",
        what.c_str(), pictures, 100.0 * rate(), 100.0 * wrong / pictures, quantile(bearing_errors_rad, 0.5) / kDegree,
        quantile(bearing_errors_rad, 0.95) / kDegree, 100.0 * quantile(distance_errors, 0.5),
        100.0 * quantile(distance_errors, 0.95));
  }
};

bool find(const std::vector<std::uint8_t>& pixels, const Camera& camera, gate_view_t& view) {
  return find_gate(pixels.data(), camera.width(), camera.height(), &view);
}

/// Returns the pose of a drone that approaches the gate, at the distance `ahead_m` in front of the gate's plane. The
/// drone is up to 20 degrees off the gate's axis, and the gate is up to 25 degrees off the centre of the picture. The
/// altitude differs from 1 m by up to 5 cm, and the drone is tilted by up to 4 degrees.
BodyPose approach_pose(Uniform& uniform, const world::scene::Gate& gate, double ahead_m) {
  BodyPose pose;
  const double off_axis = uniform(-20, 20) * kDegree;
  pose.p_WB_m = gate.p_W_m + Eigen::Vector3d(-ahead_m, -ahead_m * std::tan(off_axis), 0);
  pose.p_WB_m.z() = 1.0 + uniform(-0.05, 0.05);
  const Eigen::Vector3d line = gate.p_W_m - pose.p_WB_m;
  const double most_off = std::min(25.0, 40.0 - std::atan2(0.3, ahead_m) / kDegree) * kDegree;
  pose.yaw_rad = std::atan2(line.y(), line.x()) + uniform(-most_off, most_off);
  pose.pitch_rad = uniform(-4, 4) * kDegree;
  pose.roll_rad = uniform(-4, 4) * kDegree;
  return pose;
}

Statistics look_from_random_poses(const world::scene::Scene& scene, double nearest_m, double farthest_m, int count,
                                  std::uint64_t seed, double noise_std = 2.0) {
  Uniform uniform(seed);
  Camera camera(scene, noise_std);
  const auto& gate = scene.gates.at(0);
  Statistics statistics;
  for (int i = 0; i < count; ++i) {
    const auto pose = approach_pose(uniform, gate, uniform(nearest_m, farthest_m));
    gate_view_t view{};
    const bool seen = find(camera.take(pose, seed), camera, view);
    if (!seen && std::getenv("MEBOTS_SHOW_MISSES") != nullptr) {
      std::printf("missed from %.2f %.2f %.2f yaw %.1f\n", pose.p_WB_m.x(), pose.p_WB_m.y(), pose.p_WB_m.z(),
                  pose.yaw_rad / kDegree);
    }
    statistics.add(camera, project(camera, pose, gate.p_W_m), seen, view);
  }
  return statistics;
}

TEST(GateFinder, FindsTheEasyGateFromRandomPosesWhileTheDroneFliesToIt) {
  const auto scene = load_scene("gate_easy");
  const auto near = look_from_random_poses(scene, 0.8, 3.0, 300, 101);
  const auto far = look_from_random_poses(scene, 3.0, 6.0, 300, 102);
  near.print("gate_easy, 0.8 to 3 m");
  far.print("gate_easy, 3 to 6 m");
  for (const auto& statistics : {near, far}) {
    EXPECT_GE(statistics.rate(), 0.97);
    EXPECT_LE(statistics.wrong, 3);
    EXPECT_LT(Statistics::quantile(statistics.bearing_errors_rad, 0.95), 1.5 * kDegree);
    EXPECT_LT(Statistics::quantile(statistics.distance_errors, 0.95), 0.12);
  }
}

/// Returns the room of the easy scene with other paint and light. The walls have middle grey levels and patterns from
/// uniform to noisy. The gate is white or black.
world::scene::Scene repainted(Uniform& uniform) {
  using Kind = world::scene::Texture::Kind;
  auto scene = load_scene("gate_easy");
  const auto paint = [&](world::scene::Texture& texture) {
    constexpr Kind kKinds[] = {Kind::uniform, Kind::checker, Kind::stripes, Kind::noise, Kind::bricks};
    texture.kind = kKinds[static_cast<int>(uniform(0, 5))];
    const double middle = uniform(100, 170);
    const double swing = uniform(5, 25);
    texture.light = middle + swing;
    texture.dark = middle - swing;
    texture.scale_m = uniform(0.1, 0.6);
    texture.seed = static_cast<std::uint32_t>(uniform(0, 1e6));
  };
  paint(scene.ground.texture);
  for (auto& box : scene.boxes) paint(box.texture);
  const bool white = uniform(0, 1) < 0.5;
  scene.gates.at(0).texture.light = white ? 255.0 : uniform(5, 25);
  scene.lighting.ambient = uniform(0.5, 0.8);
  scene.lighting.sun = uniform(0.9, 1.1) - scene.lighting.ambient;
  scene.lighting.to_sun_W = Eigen::Vector3d(uniform(-1.0, -0.3), uniform(-0.7, 0.7), uniform(0.3, 1.0)).normalized();
  scene.lighting.background = uniform(150, 255);
  return scene;
}

TEST(GateFinder, FindsWhiteAndBlackGatesInRoomsOfRandomPaintAndLight) {
  Uniform uniform(103);
  Statistics statistics;
  for (int room = 0; room < 60; ++room) {
    const auto scene = repainted(uniform);
    Camera camera(scene);
    for (int i = 0; i < 5; ++i) {
      const auto pose = approach_pose(uniform, scene.gates[0], uniform(0.8, 6.0));
      gate_view_t view{};
      const bool seen = find(camera.take(pose, 103), camera, view);
      statistics.add(camera, project(camera, pose, scene.gates[0].p_W_m), seen, view);
    }
  }
  statistics.print("60 repainted rooms, 0.8 to 6 m");
  EXPECT_GE(statistics.rate(), 0.85);
  EXPECT_LE(statistics.wrong, statistics.pictures * 5 / 100);
}

TEST(GateFinder, BearsFourTimesTheCamerasNoise) {
  const auto statistics = look_from_random_poses(load_scene("gate_easy"), 0.8, 6.0, 200, 104, 8.0);
  statistics.print("gate_easy with noise of 8 grey levels, 0.8 to 6 m");
  EXPECT_GE(statistics.rate(), 0.95);
}

TEST(GateFinder, SeesNoGateInTheRoomWithoutGate) {
  auto scene = load_scene("gate_easy");
  scene.gates.clear();
  Camera camera(scene);
  Uniform uniform(105);
  int alarms = 0;
  constexpr int kPictures = 300;
  for (int i = 0; i < kPictures; ++i) {
    BodyPose pose;
    pose.p_WB_m = {uniform(-1, 8), uniform(-3, 3), uniform(0.9, 1.1)};
    pose.yaw_rad = uniform(-M_PI, M_PI);
    pose.pitch_rad = uniform(-4, 4) * kDegree;
    pose.roll_rad = uniform(-4, 4) * kDegree;
    gate_view_t view{};
    alarms += find(camera.take(pose, 105), camera, view) ? 1 : 0;
  }
  std::printf("[ measured ] room without gate: %d false alarms in %d pictures\n", alarms, kPictures);
  EXPECT_LE(alarms, kPictures / 100);
}

TEST(GateFinder, SeesNoGateInAUniformPicture) {
  for (const int grey : {0, 128, 255}) {
    const std::vector<std::uint8_t> pixels(std::size_t{320} * 320, static_cast<std::uint8_t>(grey));
    gate_view_t view{};
    EXPECT_FALSE(find_gate(pixels.data(), 320, 320, &view));
  }
}

TEST(GateFinder, SeesNoGateInASolidSquare) {
  std::vector<std::uint8_t> pixels(std::size_t{320} * 320, 100);
  for (int y = 130; y < 190; ++y) std::fill_n(&pixels[static_cast<std::size_t>(y) * 320 + 130], 60, std::uint8_t{220});
  gate_view_t view{};
  EXPECT_FALSE(find_gate(pixels.data(), 320, 320, &view));
}

/// Returns a picture of a square frame with its centre at (x, y). The frame's border is `border` pixels wide, and its
/// outer edge is six times as long.
std::vector<std::uint8_t> drawn_frame(int x, int y, int border, int edge_px = 320) {
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(edge_px) * edge_px, 100);
  for (int dy = -3 * border; dy < 3 * border; ++dy) {
    for (int dx = -3 * border; dx < 3 * border; ++dx) {
      const bool hole = dx >= -2 * border && dx < 2 * border && dy >= -2 * border && dy < 2 * border;
      if (!hole) pixels[static_cast<std::size_t>(y + dy) * edge_px + x + dx] = 200;
    }
  }
  return pixels;
}

TEST(GateFinder, PutsADrawnFrameOfAnySizeWhereItIs) {
  for (int border = 4; border <= 34; ++border) {
    SCOPED_TRACE(border);
    const auto pixels = drawn_frame(150, 165, border);
    gate_view_t view{};
    ASSERT_TRUE(find_gate(pixels.data(), 320, 320, &view));
    // The tolerance is two work pixels, each as wide as two camera pixels. One is for rounding. The other is needed
    // because the template matches at several places.
    EXPECT_NEAR(view.center_x_q4 / 16.0, 150, 4.0);
    EXPECT_NEAR(view.center_y_q4 / 16.0, 165, 4.0);
    // The template's border is a whole number of work pixels, so it matches gates of several sizes.
    EXPECT_NEAR(view.width_q4 / 16.0, 6 * border, std::max(4.0, 0.08 * 6 * border));
    EXPECT_NEAR(view.height_q4 / 16.0, 6 * border, std::max(4.0, 0.08 * 6 * border));
  }
}

TEST(GateFinder, GivesTheSameAnswerForTheSamePictureWhateverItSawBefore) {
  const auto scene = load_scene("gate_easy");
  Camera camera(scene);
  Uniform uniform(106);
  const auto pixels = camera.take(approach_pose(uniform, scene.gates[0], 3.0), 106);
  gate_view_t first{};
  gate_view_t second{};
  ASSERT_TRUE(find(pixels, camera, first));
  gate_view_t other{};
  find(drawn_frame(100, 150, 10), camera, other);
  ASSERT_TRUE(find(pixels, camera, second));
  EXPECT_EQ(first.center_x_q4, second.center_x_q4);
  EXPECT_EQ(first.center_y_q4, second.center_y_q4);
  EXPECT_EQ(first.height_q4, second.height_q4);
  EXPECT_EQ(first.contrast, second.contrast);
}

TEST(Navigator, TurnsLeftForAGateOnTheLeftAndReturnsItsDistance) {
  const auto scene = load_scene("gate_easy");
  Camera camera(scene);
  const Eigen::Vector3d gate = scene.gates[0].p_W_m;
  BodyPose pose;
  pose.p_WB_m = {gate.x() - 3.0, gate.y(), 1.0};
  for (const double yaw : {-20.0, 0.0, 20.0}) {  // drone turned right, straight, left
    SCOPED_TRACE(yaw);
    pose.yaw_rad = yaw * kDegree;
    const auto& pixels = camera.take(pose, 1);
    const auto seen = finder_navigate(pixels.data(), camera.width(), camera.height());
    const auto truth = project(camera, pose, gate);
    EXPECT_GT(seen.confidence, 128);
    EXPECT_NEAR(seen.yaw, 127.0 * (160.0 - truth.x_px) / 160.0, 127.0 * 0.02);
    EXPECT_NEAR(seen.distance_mm, 1000.0 * truth.depth_m, 0.08 * 1000.0 * truth.depth_m);
  }
}

TEST(Navigator, ReportsNoGateInAPictureWithoutGate) {
  const std::vector<std::uint8_t> pixels(std::size_t{320} * 320, 100);
  const auto seen = finder_navigate(pixels.data(), 320, 320);
  EXPECT_EQ(seen.confidence, 0);
  EXPECT_EQ(seen.yaw, 0);
  EXPECT_EQ(seen.distance_mm, 0);
}

}  // namespace
}  // namespace mebots::firmware_test
