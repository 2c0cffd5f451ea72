// SPDX-License-Identifier: Apache-2.0
// Tests the camera's view of pitched boxes, cylinders, meshes, picture textures and moving bodies.
#include "camera/tile.hpp"
#include "camera_scenes.hpp"
#include "math/rotation.hpp"
#include "support/shapes.hpp"

#include <gtest/gtest.h>
#include <cmath>

namespace mebots::world::camera {
namespace {

using Eigen::Vector3d;
using testing::Picture;
using testing::pose;

scene::Box block(const Vector3d& p_W_m, const Vector3d& size_m) {
  return {"block", p_W_m, size_m, 0.0, testing::uniform(200.0)};
}

TEST(CameraShapes, APitchedBoxCoversWhatItsCornersProjectTo) {
  scene::Scene scene = testing::dark_scene();
  scene::Box plate = block({3.0, 0.0, 1.0}, {0.6, 0.8, 0.02});
  plate.pitch_rad = -1.0;  // its upper side faces the camera
  scene.boxes = {plate};
  Renderer renderer(scene, {}, 0.0);
  const Pose from = pose({0.0, 0.0, 1.0});
  const Picture seen = testing::picture(renderer, from);
  // Points of the plate's upper face: bright inside, dark outside of the edges.
  const Eigen::Quaterniond turned = rotation_of({0.0, -1.0, 0.0});
  for (const double a : {-0.93, -0.4, 0.0, 0.7, 0.93}) {
    for (const double b : {-0.95, 0.1, 0.95}) {
      const Vector3d inside = plate.p_W_m + turned * Vector3d(0.3 * a, 0.4 * b, 0.01);
      const Vector3d beyond = plate.p_W_m + turned * Vector3d(0.3 * a, 0.4 * (b + (b < 0 ? -1.1 : 1.1)), 0.01);
      const auto in = testing::projected(inside, from, {});
      const auto out = testing::projected(beyond, from, {});
      EXPECT_EQ(seen.at(static_cast<int>(in.x()), static_cast<int>(in.y())), 200) << a << " " << b;
      EXPECT_EQ(seen.at(static_cast<int>(out.x()), static_cast<int>(out.y())), 0) << a << " " << b;
    }
  }
}

TEST(CameraShapes, ACylinderIsAsWideAsItsDiameter) {
  scene::Scene scene = testing::dark_scene();
  scene::Cylinder pillar;
  pillar.p_W_m = {4.0, 0.0, 1.0};
  pillar.radius_m = 0.5;
  pillar.height_m = 1.0;
  pillar.texture = testing::uniform(200.0);
  scene.cylinders = {pillar};
  Renderer renderer(scene, {}, 0.0);
  const Picture seen = testing::picture(renderer, pose({0.0, 0.0, 1.0}));
  int columns = 0;
  for (int column = 0; column < 320; ++column) columns += seen.at(column, 160) == 200 ? 1 : 0;
  // A ray that grazes a circle of radius r, with its centre at the distance d, has the slope r / sqrt(d^2 - r^2) to the
  // ray through the centre. With 32 sides, the cylinder is at most half a per cent narrower. The number of pixels may
  // differ by one from the exact width.
  const double wide_px = 2.0 * Intrinsics{}.focal_length_px() * 0.5 / std::sqrt(16.0 - 0.25);
  EXPECT_LE(columns, wide_px + 1.0);
  EXPECT_GE(columns, 0.995 * wide_px - 1.0);
}

TEST(CameraShapes, AMeshLooksAsTheBoxOfItsShapeFromEverywhere) {
  scene::Scene of_box = testing::dark_scene();
  of_box.lighting = {0.3, 0.6, Vector3d(-0.5, 0.2, 0.8).normalized(), 0.0};
  scene::Box box = block({2.0, 0.3, 1.0}, {0.5, 0.4, 0.3});
  box.yaw_rad = 0.4;
  box.pitch_rad = 0.3;
  box.roll_rad = -0.2;
  of_box.boxes = {box};
  scene::Scene of_mesh = of_box;
  of_mesh.boxes.clear();
  of_mesh.meshes = {
      {"mesh", box.p_W_m, box.yaw_rad, box.pitch_rad, box.roll_rad, test::box_mesh(box.size_m, box.texture)}};
  Renderer boxes(of_box, {}, 0.0);
  Renderer meshes(of_mesh, {}, 0.0);
  for (double turn = 0.0; turn < 6.2; turn += 0.7) {
    const Pose from = pose({2.0 - 1.2 * std::cos(turn), 0.3 - 1.2 * std::sin(turn), 1.2}, turn, 0.1);
    // The two triangles of a side share an edge without a gap. Only pixels at the silhouette may differ, because of
    // rounding.
    EXPECT_LE(testing::differing_pixels(testing::picture(boxes, from), testing::picture(meshes, from)), 3) << turn;
  }
}

/// Returns a picture with a black left half and a white right half. Its upper left quarter is grey.
std::shared_ptr<const scene::Picture> quarters() {
  scene::Picture picture{8, 4, {}};
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 8; ++column) {
      picture.grey.push_back(static_cast<std::uint8_t>(column >= 4 ? 255 : row < 2 ? 128 : 0));
    }
  }
  return std::make_shared<const scene::Picture>(picture);
}

TEST(CameraShapes, APictureIsUprightAndFitsTheSideThatIsAsWide) {
  scene::Scene scene = testing::dark_scene();
  scene::Box board = block({2.0, 0.0, 1.0}, {0.02, 1.6, 0.8});
  board.texture.kind = scene::Texture::Kind::picture;
  board.texture.picture = quarters();
  board.texture.light = 200.0;
  board.texture.dark = 20.0;
  board.texture.scale_m = 1.6;
  scene.boxes = {board};
  Renderer renderer(scene, {}, 0.0);
  const Pose from = pose({0.0, 0.0, 1.0});
  const Picture seen = testing::picture(renderer, from);
  const auto grey_at = [&](double left_m, double up_m) {
    const auto at = testing::projected({1.99, left_m, 1.0 + up_m}, from, {});
    return seen.at(static_cast<int>(at.x()), static_cast<int>(at.y()));
  };
  EXPECT_EQ(grey_at(0.4, -0.2), 20);  // lower left
  EXPECT_NEAR(grey_at(0.4, 0.2), 20.0 + 180.0 * 128 / 255, 1.0);
  EXPECT_EQ(grey_at(-0.4, 0.2), 200);  // upper right
  EXPECT_EQ(grey_at(-0.4, -0.2), 200);
}

TEST(CameraShapes, TextureCoordinatesOfAMeshPutThePictureWhereTheySay) {
  // The triangle shows the picture's lower left half, rotated by a quarter turn.
  scene::Mesh mesh;
  scene::Texture texture;
  texture.kind = scene::Texture::Kind::picture;
  texture.picture = quarters();
  texture.light = 255.0;
  texture.dark = 0.0;
  texture.scale_m = 1.0;
  mesh.materials = {texture};
  mesh.points_m = {
      {0.0, 0.5, -0.5}, {0.0, -0.5, -0.5}, {0.0, 0.5, 0.5}};  // lower left, lower right, upper left as seen
  mesh.triangles = {{{0, 1, 2}, 0, std::array<Eigen::Vector2d, 3>{{{1.0, 0.0}, {1.0, 1.0}, {0.0, 0.0}}}}};
  scene::Scene scene = testing::dark_scene();
  scene.meshes = {{"mesh", {2.0, 0.0, 1.0}, 0.0, 0.0, 0.0, std::make_shared<const scene::Mesh>(mesh)}};
  Renderer renderer(scene, {}, 0.0);
  const Pose from = pose({0.0, 0.0, 1.0});
  const Picture seen = testing::picture(renderer, from);
  const auto grey_at = [&](double left_m, double up_m) {
    const auto at = testing::projected({2.0, left_m, 1.0 + up_m}, from, {});
    return seen.at(static_cast<int>(at.x()), static_cast<int>(at.y()));
  };
  EXPECT_EQ(grey_at(0.4, -0.4), 255);    // u = 0.9, v = 0.1: right half
  EXPECT_EQ(grey_at(0.3, 0.2), 0);       // u = 0.3, v = 0.2: lower left quarter
  EXPECT_EQ(grey_at(-0.1, -0.25), 255);  // u = 0.75, v = 0.6
}

TEST(CameraShapes, AMoverLooksLikeAThingAtRestAtItsPlace) {
  scene::Scene moving = testing::patterned_room();
  moving.boxes[3].path.points = {{0, Vector3d::Zero(), 0.0}, {3'000'000'000, {0.9, 0.6, 0.3}, 1.2}};
  Renderer of_mover(moving, {}, 0.0);
  for (const double time_s : {0.0, 0.8, 2.1, 3.0, 7.0}) {
    const auto time_ns = std::llround(time_s * 1e9);
    const auto moved = moving.boxes[3].path.at(time_ns);
    scene::Scene standing = moving;
    standing.boxes[3].path = {};
    standing.boxes[3].p_W_m += moved.offset_W_m;
    standing.boxes[3].yaw_rad += moved.turn_rad;
    Renderer of_standing(standing, {}, 0.0);
    Pose from = pose({0.0, 0.0, 1.0}, -0.2);
    from.time_ns = time_ns;
    const Picture a = testing::picture(of_mover, from);
    const Picture b = testing::picture(of_standing, from);
    int far = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) far += std::abs(a.pixels[i] - b.pixels[i]) > 1 ? 1 : 0;
    EXPECT_LE(far, 8) << time_s;  // at silhouettes
  }
}

}  // namespace
}  // namespace mebots::world::camera
