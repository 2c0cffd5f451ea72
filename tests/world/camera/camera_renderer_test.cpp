// SPDX-License-Identifier: Apache-2.0
#include "camera_scenes.hpp"
#include "mebots/error.hpp"
#include "support/allocations.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <thread>

namespace mebots::world::camera {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;
using testing::Picture;
using testing::pose;
using ::testing::ThrowsMessage;

TEST(Camera, NearerThingsHideFartherOnesInWhateverOrderTheyAreListed) {
  scene::Scene scene = testing::room();
  Renderer first(scene, {}, 0.0);
  std::sort(scene.boxes.begin(), scene.boxes.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  std::swap(scene.gates[0], scene.gates[1]);
  Renderer second(scene, {}, 0.0);
  for (const Pose& from : testing::awkward_poses()) {
    EXPECT_EQ(testing::picture(first, from), testing::picture(second, from));
  }
}

TEST(Camera, ABoxBehindAnotherAppearsOnlyThroughTheGap) {
  scene::Scene scene = testing::dark_scene();
  scene.boxes = {{"near", {2.0, 0.0, 1.0}, {0.1, 0.5, 0.5}, 0.0, testing::uniform(100.0)},
                 {"far", {3.0, 0.0, 1.0}, {0.1, 1.5, 0.2}, 0.0, testing::uniform(200.0)}};
  Renderer renderer(scene, {}, 0.0);
  const Picture seen = testing::picture(renderer, pose({0.0, 0.0, 1.0}));
  const double f = Intrinsics{}.focal_length_px();
  const int near_edge = static_cast<int>(160 + f * 0.25 / 1.95);
  const int far_edge = static_cast<int>(160 + f * 0.75 / 2.95);
  EXPECT_EQ(seen.at(160, 160), 100);
  EXPECT_EQ(seen.at(near_edge - 2, 160), 100);
  EXPECT_EQ(seen.at(near_edge + 2, 160), 200);
  EXPECT_EQ(seen.at(far_edge - 2, 160), 200);
  EXPECT_EQ(seen.at(far_edge + 2, 160), 0);
}

TEST(Camera, LightFollowsLambert) {
  scene::Scene scene = testing::dark_scene();
  scene.lighting.ambient = 0.3;
  scene.lighting.sun = 0.6;
  scene.boxes = {{"block", {2.0, 0.0, 1.0}, {0.5, 0.5, 0.5}, 0.0, testing::uniform(200.0)}};
  for (double turn = 0.0; turn < 6.3; turn += 0.2) {
    scene.lighting.to_sun_W = Vector3d(-std::cos(turn), std::sin(turn) * 0.6, std::sin(turn) * 0.8);
    Renderer renderer(scene, {}, 0.0);
    const Picture seen = testing::picture(renderer, pose({0.0, 0.0, 1.0}));
    const double cosine = std::max(0.0, std::cos(turn));
    // Permits rounding to a whole grey level.
    EXPECT_NEAR(seen.at(160, 160), 200.0 * (0.3 + 0.6 * cosine), 0.51) << "turn " << turn;
  }
}

TEST(Camera, ScalesTextureByLightAndSaturates) {
  scene::Scene scene = testing::dark_scene();
  scene.boxes = {{"block",
                  {2.0, 0.0, 1.0},
                  {0.5, 0.5, 0.5},
                  0.0,
                  testing::patterned(scene::Texture::Kind::checker, 200.0, 50.0, 0.25)}};
  scene.lighting.ambient = 2.0;
  Renderer renderer(scene, {}, 0.0);
  const Picture seen = testing::picture(renderer, pose({0.0, 0.0, 1.0}));
  EXPECT_EQ(seen.at(150, 170), 255);  // the lower left square is light
  EXPECT_EQ(seen.at(170, 170), 100);
  EXPECT_EQ(seen.at(170, 150), 255);
}

TEST(Camera, SameArgumentsGiveTheSameBytesTwiceAndInTwoRenderers) {
  Renderer first(testing::patterned_room(), {}, 2.0);
  Renderer second(testing::patterned_room(), {}, 2.0);
  for (const Pose& from : testing::awkward_poses()) {
    const Picture once = testing::picture(first, from, 9, 4);
    testing::picture(first, pose({1.0, 1.0, 1.0}), 3, 5);
    EXPECT_EQ(testing::picture(first, from, 9, 4), once);
    EXPECT_EQ(testing::picture(second, from, 9, 4), once);
    EXPECT_NE(testing::picture(first, from, 9, 5), once);
    EXPECT_NE(testing::picture(first, from, 8, 4), once);
  }
}

TEST(Camera, ThreadsWithTheirOwnWorkspacesGetTheSamePictures) {
  Renderer renderer(testing::patterned_room(), {}, 2.0);
  const std::vector<Pose> poses = testing::awkward_poses();
  std::vector<Picture> expected;
  for (const Pose& from : poses) expected.push_back(testing::picture(renderer, from));
  const Renderer& shared = renderer;
  std::atomic<int> wrong{0};
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      Renderer::Workspace workspace = shared.make_workspace();
      std::vector<std::uint8_t> pixels(320 * 320);
      for (std::size_t i = 0; i < poses.size(); ++i) {
        const std::size_t k = (i + 3 * t) % poses.size();
        shared.render(poses[k], 1, 0, pixels, workspace);
        if (pixels != expected[k].pixels) ++wrong;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, 0);
}

TEST(Camera, ACopyOfARendererIsIndependent) {
  const Pose from = pose({0.0, 0.0, 1.0});
  std::vector<Renderer> renderers;
  Picture expected{};
  {
    Renderer original(testing::patterned_room(), {}, 2.0);
    expected = testing::picture(original, from);
    renderers.push_back(original);
  }
  EXPECT_EQ(testing::picture(renderers[0], from), expected);
}

TEST(Camera, RenderingNeedsNoHeap) {
  Renderer renderer(testing::patterned_room(), {}, 2.0);
  std::vector<std::uint8_t> pixels(320 * 320);
  const std::vector<Pose> poses = testing::awkward_poses();
  const long before = mebots::test::allocations();
  for (const Pose& from : poses) renderer.render(from, 1, 2, pixels);
  EXPECT_EQ(mebots::test::allocations(), before);
}

TEST(Camera, OddSizesAreRenderedToo) {
  // A picture of another size with the same focal length shows the same middle part.
  const Intrinsics large{320, 320, 1.51844};
  const double f = large.focal_length_px();
  const Intrinsics small{258, 34, 2.0 * std::atan(0.5 * 258 / f)};
  Renderer of_large(testing::patterned_room(), large, 0.0);
  Renderer of_small(testing::patterned_room(), small, 0.0);
  for (const Pose& from : testing::awkward_poses()) {
    const Picture a = testing::picture(of_large, from);
    const Picture b = testing::picture(of_small, from);
    int wrong = 0;
    for (int row = 0; row < 34; ++row) {
      for (int column = 0; column < 258; ++column) {
        wrong += std::abs(a.at(column + 31, row + 143) - b.at(column, row)) > 1 ? 1 : 0;
      }
    }
    EXPECT_LE(wrong, 2);  // the focal lengths differ in their last bits, which can change a pixel on an edge
  }
}

TEST(Camera, RefusesWhatItCannotRender) {
  const scene::Scene scene = testing::room();
  EXPECT_THAT([&] { Renderer(scene, {4, 320, 1.5}, 0.0); }, ThrowsMessage<Error>(HasSubstr("width of 4 pixels")));
  EXPECT_THAT([&] { Renderer(scene, {320, 4096, 1.5}, 0.0); }, ThrowsMessage<Error>(HasSubstr("8..2048")));
  EXPECT_THAT(
      [&] {
        Renderer(scene, {320, 320, 3.2}, 0.0);
      },
      ThrowsMessage<Error>(HasSubstr("field of view of 3.2 rad")));
  EXPECT_THAT([&] { Renderer(scene, {}, -1.0); }, ThrowsMessage<Error>(HasSubstr("deviation -1")));
  Renderer renderer(scene, {}, 0.0);
  std::vector<std::uint8_t> pixels(100);
  EXPECT_THAT([&] { renderer.render({}, 1, 0, pixels); },
              ThrowsMessage<Error>(HasSubstr("needs 102400 bytes, not 100")));
}

}  // namespace
}  // namespace mebots::world::camera
