// SPDX-License-Identifier: Apache-2.0
#include "camera/ground_truth.hpp"

#include "camera_scenes.hpp"
#include "sensors/ray_caster.hpp"

#include <gmock/gmock.h>
#include <cmath>
#include <memory>

namespace mebots::world::camera {
namespace {

using testing::dark_scene;
using testing::picture;
using testing::pose;
using testing::room;
using testing::uniform;

constexpr Intrinsics kFormat{160, 120, 1.3};

std::shared_ptr<const Scenery> scenery_of(const scene::Scene& scene) {
  return std::make_shared<const Scenery>(make_geometry(scene));
}

std::size_t pixel_at(int column, int row) {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(kFormat.width) + static_cast<std::size_t>(column);
}

/// Returns the camera's direction through a pixel of an undistorted picture. Its component along the axis is 1.
Eigen::Vector3d direction_of(const Pose& from, double right_px, double down_px) {
  const double f = kFormat.focal_length_px();
  return from.R_WC * Eigen::Vector3d(1.0, -right_px / f, -down_px / f);
}

/// Returns the depth along a direction by ray casting. Beyond the drawn ground, returns 0.
double cast_m(const RayCaster& rays, const scene::Scene& scene, const Pose& from, const Eigen::Vector3d& direction_W) {
  const double distance_m = rays.distance_m(from.p_WC_m, direction_W.normalized(), 0, {});
  if (std::isinf(distance_m)) return 0.0;
  const Eigen::Vector3d hit_W_m = from.p_WC_m + distance_m * direction_W.normalized();
  const bool is_drawn = hit_W_m.head<2>().cwiseAbs().maxCoeff() <= scene.ground.half_size_m || hit_W_m.z() > 1e-6;
  return is_drawn ? distance_m / direction_W.norm() : 0.0;
}

std::vector<double> depths_m(GroundTruth& truth, const Pose& from, std::uint64_t index = 0) {
  std::vector<std::uint8_t> bytes(2U * kFormat.width * kFormat.height);
  truth.depth([&](double) { return from; }, 0.0, 1, index, bytes);
  std::vector<double> depths;
  for (std::size_t i = 0; i < bytes.size(); i += 2) depths.push_back(0.001 * (bytes[i] + 256 * bytes[i + 1]));
  return depths;
}

scene::Scene room_with_ring() {
  scene::Scene scene = room();
  scene::MeshThing ring;
  ring.p_W_m = {2.5, 0.8, 0.9};
  ring.yaw_rad = 0.4;
  ring.mesh = std::make_shared<const scene::Mesh>(scene::ring(6, 0.4, 0.7, 0.05, uniform(100.0)));
  scene.meshes.push_back(ring);
  return scene;
}

const std::vector<Pose> kRoomPoses{pose({0.0, 0.0, 1.0}), pose({3.99, 0.39, 1.2}, 1.2, 0.3, 0.4),
                                   pose({2.0, 0.0, 2.5}, 0.4, 1.5), pose({4.5, 0.0, 1.1}, 3.3, 0.0, -0.5)};

TEST(GroundTruth, DepthsAreThoseOfRaysThroughThePixels) {
  const scene::Scene scene = room_with_ring();
  const RayCaster rays(scene);
  GroundTruth truth(scenery_of(scene), kFormat, {}, 0.0, 0.0);
  int compared = 0;
  int different = 0;
  for (const Pose& from : kRoomPoses) {
    const auto depths = depths_m(truth, from);
    for (int row = 0; row < kFormat.height; ++row) {
      for (int column = 0; column < kFormat.width; ++column) {
        const auto ray_W = direction_of(from, column + 0.5 - 0.5 * kFormat.width, row + 0.5 - 0.5 * kFormat.height);
        const double expected_m = cast_m(rays, scene, from, ray_W);
        const double depth_m = depths[pixel_at(column, row)];
        ++compared;
        // Permits half a millimetre of rounding. The renderer's planes have single precision.
        if (std::abs(depth_m - expected_m) > 0.0005 + 2e-5 * expected_m) ++different;
      }
    }
  }
  // The renderer rounds corners to 1/4096 pixel, so a few pixel centres are on the other side of an edge.
  EXPECT_LE(different, compared / 2000) << "of " << compared;
}

TEST(GroundTruth, DepthsFollowTheLens) {
  const scene::Scene scene = room_with_ring();
  const RayCaster rays(scene);
  const LensSettings lens{-0.2, 0.02, 0.0};
  GroundTruth truth(scenery_of(scene), kFormat, lens, 0.0, 0.0);
  const double f = kFormat.focal_length_px();
  int different = 0;
  const auto depths = depths_m(truth, kRoomPoses[0]);
  for (int row = 0; row < kFormat.height; ++row) {
    for (int column = 0; column < kFormat.width; ++column) {
      const double x = (column + 0.5 - 0.5 * kFormat.width) / f;
      const double y = (row + 0.5 - 0.5 * kFormat.height) / f;
      const double at = std::hypot(x, y);
      double r = at;  // solves r (1 + k1 r^2 + k2 r^4) = at by a fixed point
      for (int i = 0; i < 200; ++i) r = at / (1.0 + r * r * (lens.k1 + lens.k2 * r * r));
      const double stretch = at > 0.0 ? r / at : 1.0;
      const double expected_m =
          cast_m(rays, scene, kRoomPoses[0], direction_of(kRoomPoses[0], f * x * stretch, f * y * stretch));
      const double depth_m = depths[pixel_at(column, row)];
      if (std::abs(depth_m - expected_m) > 0.0005 + 2e-5 * expected_m) ++different;
    }
  }
  // GroundTruth uses the nearest pixel of the undistorted picture. Near an edge between two faces, this pixel may show
  // another face than the exact ray.
  EXPECT_LE(different, kFormat.width * kFormat.height / 33);
}

TEST(GroundTruth, DepthNoiseGrowsWithTheSquareOfTheDepth) {
  scene::Scene scene = dark_scene();
  scene.boxes = {{"wall", {3.1, 0.0, 0.0}, {0.2, 40.0, 40.0}, 0.0, uniform(100.0)}};
  constexpr double kNoise_per_m = 0.002;
  GroundTruth truth(scenery_of(scene), kFormat, {}, 0.0, kNoise_per_m);
  const auto depths = depths_m(truth, pose({0.0, 0.0, 1.0}), 3);
  double sum = 0.0;
  double squares = 0.0;
  int count = 0;
  for (int i = 0; i < kFormat.width * kFormat.height / 2; ++i) {  // the upper half shows the wall only
    const double error_m = depths[static_cast<std::size_t>(i)] - 3.0;
    sum += error_m;
    squares += error_m * error_m;
    ++count;
  }
  const double sigma_m = std::hypot(kNoise_per_m * 9.0, 0.001 / std::sqrt(12.0));
  EXPECT_NEAR(sum / count, 0.0, 4.0 * sigma_m / std::sqrt(count));
  EXPECT_NEAR(std::sqrt(squares / count), sigma_m, 4.0 * sigma_m / std::sqrt(2.0 * count));
  EXPECT_EQ(depths_m(truth, pose({0.0, 0.0, 1.0}), 3), depths);
  EXPECT_NE(depths_m(truth, pose({0.0, 0.0, 1.0}), 4), depths);
}

/// Returns the box around all pixels that are not black, and the number of these pixels.
std::pair<PixelBox, int> bright_pixels(const scene::Scene& scene, const Pose& from) {
  Renderer renderer(scene, kFormat, 0.0);
  const auto image = picture(renderer, from);
  PixelBox box;
  int count = 0;
  for (int row = 0; row < kFormat.height; ++row) {
    for (int column = 0; column < kFormat.width; ++column) {
      if (image.at(column, row) == 0) continue;
      box.add(column, row);
      ++count;
    }
  }
  return {box, count};
}

scene::Scene white_gate(const Eigen::Vector3d& p_W_m, double yaw_rad = 0.0) {
  scene::Scene scene = dark_scene();
  scene::Gate gate;
  gate.name = "gate 1";
  gate.p_W_m = p_W_m;
  gate.yaw_rad = yaw_rad;
  gate.texture = uniform(250.0);
  scene.gates.push_back(gate);
  return scene;
}

std::vector<SeenObject> objects(const scene::Scene& scene, const Pose& from) {
  GroundTruth truth(scenery_of(scene), kFormat, {}, 0.0, 0.0);
  return truth.objects([&](double) { return from; }, 0.0);
}

TEST(GroundTruth, ABoxIsTightAroundTheObjectsPixels) {
  for (const double yaw_rad : {0.0, 0.5, 1.2}) {
    for (const Pose& from :
         {pose({0.0, 0.0, 1.0}), pose({0.2, -0.3, 1.2}, 0.3, 0.1, 0.4), pose({2.6, 0.0, 1.0}, 0.2)}) {
      const scene::Scene scene = white_gate({3.0, 0.3, 1.0}, yaw_rad);
      const auto seen = objects(scene, from);
      const auto [box, count] = bright_pixels(scene, from);
      ASSERT_EQ(seen.size(), 1U);
      EXPECT_EQ(seen[0].kind, SceneObject::Kind::gate);
      EXPECT_EQ(seen[0].name, "gate 1");
      EXPECT_EQ(seen[0].box, box);
      EXPECT_EQ(seen[0].visible_box, box);
      EXPECT_EQ(seen[0].pixels, count);
      EXPECT_EQ(seen[0].visible_pixels, count);
      EXPECT_DOUBLE_EQ(seen[0].distance_m, (Eigen::Vector3d(3.0, 0.3, 1.0) - from.p_WC_m).norm());
    }
  }
}

TEST(GroundTruth, AHiddenPartCountsAsInvisible) {
  const Pose from = pose({0.0, 0.0, 1.0});
  const scene::Scene open = white_gate({3.0, 0.0, 1.0});
  scene::Scene hidden = open;
  hidden.boxes = {{"pillar", {2.0, 0.3, 1.0}, {0.2, 0.5, 2.0}, 0.0, uniform(0.0)}};
  const auto seen = objects(hidden, from);
  ASSERT_EQ(seen.size(), 1U);
  const auto [whole_box, whole_count] = bright_pixels(open, from);
  const auto [visible_box, visible_count] = bright_pixels(hidden, from);
  EXPECT_LT(visible_count, whole_count);
  EXPECT_EQ(seen[0].box, whole_box);
  EXPECT_EQ(seen[0].pixels, whole_count);
  EXPECT_EQ(seen[0].visible_box, visible_box);
  EXPECT_EQ(seen[0].visible_pixels, visible_count);

  hidden.boxes[0].size_m = {0.2, 4.0, 4.0};
  const auto behind = objects(hidden, from);
  ASSERT_EQ(behind.size(), 1U);
  EXPECT_EQ(behind[0].box, whole_box);
  EXPECT_TRUE(behind[0].visible_box.empty());
  EXPECT_EQ(behind[0].visible_pixels, 0);
}

TEST(GroundTruth, LeavesOutObjectsBesideThePicture) {
  EXPECT_TRUE(objects(white_gate({3.0, 0.0, 1.0}), pose({0.0, 0.0, 1.0}, 1.5)).empty());
  EXPECT_TRUE(objects(white_gate({-3.0, 0.0, 1.0}), pose({0.0, 0.0, 1.0})).empty());
}

TEST(GroundTruth, MarksOtherDronesButNotItsOwn) {
  scene::Scene scene = dark_scene();
  Geometry geometry = make_geometry(scene);
  for (std::size_t i = 0; i < 2; ++i) add_drone(geometry, scene.drone, i);
  GroundTruth truth(std::make_shared<const Scenery>(std::move(geometry)), kFormat, {}, 0.0, 0.0);
  const std::vector<BodyPose> bodies{{{0.0, 0.0, 1.0}, Eigen::Matrix3d::Identity()},
                                     {{1.0, 0.2, 1.1}, Eigen::Matrix3d::Identity()}};
  Pose from = pose({0.03, 0.0, 1.0});
  from.bodies = bodies;
  from.own_body = 0;
  const auto seen = truth.objects([&](double) { return from; }, 0.0);
  ASSERT_EQ(seen.size(), 1U);
  EXPECT_EQ(seen[0].kind, SceneObject::Kind::drone);
  EXPECT_EQ(seen[0].name, "drone[2]");
  EXPECT_DOUBLE_EQ(seen[0].distance_m, Eigen::Vector3d(0.97, 0.2, 0.1).norm());
  // The left end of the box is at the disc of the left front rotor.
  const double arm_m = scene.drone.arm_m;
  const double slope = (0.2 + (1.0 + kRotorRadiusOverArm) * arm_m) / (0.97 - arm_m);
  EXPECT_NEAR(seen[0].box.left, 0.5 * kFormat.width - kFormat.focal_length_px() * slope, 1.0);
  EXPECT_EQ(seen[0].pixels, seen[0].visible_pixels);
}

}  // namespace
}  // namespace mebots::world::camera
