// SPDX-License-Identifier: Apache-2.0
#include "camera/tile.hpp"
#include "camera_scenes.hpp"
#include "mebots/error.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace mebots::world::camera {
namespace {

using Kind = scene::Texture::Kind;

TEST(CameraTexture, EveryLevelHasTheMeanOfTheTile) {
  const Ripmap ripmap(16, 1, [](double u, double v) { return 100.0 + 80.0 * std::sin(7.0 * u) * std::cos(3.0 * v); });
  for (int lu = 0; lu <= 4; ++lu) {
    for (int lv = 0; lv <= 4; ++lv) {
      double sum = 0.0;
      double exact = 0.0;
      for (int y = 0; y < 16 >> lv; ++y) {
        for (int x = 0; x < 16 >> lu; ++x) sum += ripmap.texel(lu, lv, x, y);
      }
      for (int y = 0; y < 16; ++y) {
        for (int x = 0; x < 16; ++x) exact += ripmap.texel(0, 0, x, y) / 256.0;
      }
      // Permits two roundings to whole grey levels.
      EXPECT_NEAR(sum / ((16 >> lu) * (16 >> lv)), exact, 1.0) << lu << ", " << lv;
    }
  }
}

TEST(CameraTexture, ALevelIsHalvedAlongItsOwnAxisOnly) {
  const Ripmap ripmap(8, 1, [](double u, double) { return u < 0.5 ? 200.0 : 0.0; });
  for (int x = 0; x < 8; ++x) EXPECT_EQ(ripmap.texel(0, 3, x, 0), x < 4 ? 200 : 0);
  for (int y = 0; y < 8; ++y) EXPECT_EQ(ripmap.texel(3, 0, 0, y), 100);
}

TEST(CameraTexture, AWordHoldsATexelAndItsNeighboursRoundTheTilesEdge) {
  const Ripmap ripmap(4, 1, [](double u, double v) { return 10.0 * std::floor(4.0 * u) + 50.0 * std::floor(4.0 * v); });
  const auto word = [&](int x, int y) { return ripmap.words()[(y << ripmap.row_shift()) + x]; };
  EXPECT_EQ(word(1, 2), 110U | 120U << 8 | 160U << 16 | 170U << 24);
  EXPECT_EQ(word(3, 3), 180U | 150U << 8 | 30U << 16 | 0U << 24);
}

TEST(CameraTexture, SizesThatAreNoPowersOfTwoAreRefused) {
  const auto grey = [](double, double) { return 1.0; };
  EXPECT_THROW(Ripmap(12, 1, grey), Error);
  EXPECT_THROW(Ripmap(0, 1, grey), Error);
  EXPECT_NO_THROW(Ripmap(1, 1, grey));
}

TEST(CameraTexture, PatternsStayBetweenDarkAndLightAndUseBoth) {
  for (const Kind kind : {Kind::checker, Kind::stripes, Kind::noise}) {
    const Tile tile = make_tile(testing::patterned(kind, 200.0, 40.0, 0.5));
    int least = 255;
    int most = 0;
    for (int y = 0; y < tile.ripmap.size(); ++y) {
      for (int x = 0; x < tile.ripmap.size(); ++x) {
        least = std::min(least, tile.ripmap.texel(0, 0, x, y));
        most = std::max(most, tile.ripmap.texel(0, 0, x, y));
      }
    }
    EXPECT_GE(least, 40);
    EXPECT_LE(most, 200);
    // Value noise rarely reaches its limits.
    EXPECT_LE(least, kind == Kind::noise ? 75 : 40);
    EXPECT_GE(most, kind == Kind::noise ? 165 : 200);
  }
}

TEST(CameraTexture, NoiseDependsOnItsSeedOnly) {
  scene::Texture texture = testing::patterned(Kind::noise, 200.0, 40.0, 0.5);
  const auto centre = [&] { return make_tile(texture).ripmap.texel(0, 0, 100, 37); };
  const int first = centre();
  EXPECT_EQ(centre(), first);
  int others = 0;
  for (texture.seed = 100; texture.seed < 110; ++texture.seed) others += centre() != first ? 1 : 0;
  EXPECT_GE(others, 8);
}

TEST(CameraTexture, StripesChangeEachWidthAlongTheFirstAxis) {
  const Tile tile = make_tile(testing::patterned(Kind::stripes, 200.0, 40.0, 0.3));
  EXPECT_DOUBLE_EQ(tile.edge_u_m, 0.6);
  const int size = tile.ripmap.size();
  for (int i = 0; i < size; ++i) {
    EXPECT_EQ(tile.ripmap.texel(0, 0, i, 5), i < size / 2 ? 200 : 40);
    EXPECT_EQ(tile.ripmap.texel(0, 0, 5, i), 200);
  }
}

/// Returns a picture of the ground from a height of 1 m. The camera is `way_m` east and 0.6 `way_m` north of the
/// origin.
testing::Picture ground_from(Renderer& renderer, double way_m, double yaw_rad) {
  return testing::picture(renderer, testing::pose({way_m, 0.6 * way_m, 1.0}, yaw_rad));
}

TEST(CameraTexture, FarGroundFadesToItsMeanInsteadOfShimmering) {
  scene::Scene scene = testing::dark_scene();
  scene.ground.half_size_m = 100.0;
  scene.ground.texture = testing::patterned(Kind::checker, 200.0, 40.0, 0.05);
  Renderer renderer(scene, {}, 0.0);
  for (const double yaw_rad : {0.0, 0.4, 0.785}) {
    const testing::Picture first = ground_from(renderer, 0.0, yaw_rad);
    const testing::Picture later = ground_from(renderer, 0.013, yaw_rad);
    double change = 0.0;
    double difference = 0.0;
    int pixels = 0;
    for (int row = 162; row < 170; ++row) {  // 17 m and more away, where a pixel covers over 0.1 m x 2 m
      for (int column = 0; column < 320; ++column, ++pixels) {
        change += std::abs(first.at(column, row) - later.at(column, row));
        difference += std::abs(first.at(column, row) - 120.0);
      }
    }
    // A single sample per pixel would differ by 80 from the mean, and by about 40 between pictures.
    EXPECT_LT(difference / pixels, 4.0) << "yaw " << yaw_rad;
    EXPECT_LT(change / pixels, 4.0) << "yaw " << yaw_rad;
  }
}

TEST(CameraTexture, GroundAcrossTheViewIsNotSmearedAlongTheView) {
  // Stripes along the view are 50 cm wide. At 8 m, a pixel covers 5 cm x 38 cm. Averaging over the longer side in both
  // directions would remove most of the contrast.
  scene::Scene scene = testing::dark_scene();
  scene.ground.half_size_m = 100.0;
  scene.ground.texture = testing::patterned(Kind::checker, 200.0, 40.0, 0.5);
  Renderer renderer(scene, {}, 0.0);
  const testing::Picture seen = testing::picture(renderer, testing::pose({0.13, 0.0, 1.0}));
  int least = 255;
  int most = 0;
  for (int row = 179; row < 183; ++row) {
    for (int column = 0; column < 320; ++column) {
      least = std::min(least, seen.at(column, row));
      most = std::max(most, seen.at(column, row));
    }
  }
  EXPECT_GT(most - least, 120);
}

TEST(CameraTexture, IsDrawnOnceForAllWorldsThatUseIt) {
  const auto texture = testing::patterned(scene::Texture::Kind::noise, 200.0, 40.0, 0.5);
  auto other = texture;
  other.seed = texture.seed + 1;
  const auto first = shared_tile(texture);
  EXPECT_EQ(shared_tile(texture), first);
  EXPECT_NE(shared_tile(other), first);
  EXPECT_EQ(shared_tile(texture)->ripmap.texel(0, 0, 100, 37), make_tile(texture).ripmap.texel(0, 0, 100, 37));
}

TEST(CameraTexture, IsGoneWithTheLastWorldThatUsesIt) {
  auto texture = testing::patterned(scene::Texture::Kind::noise, 200.0, 40.0, 0.5);
  auto first = shared_tile(texture);
  const auto second = shared_tile(texture);
  const std::weak_ptr<const Tile> seen = first;
  first.reset();
  EXPECT_EQ(shared_tile(texture), second);
  ++texture.seed;
  const std::weak_ptr<const Tile> other = shared_tile(texture);
  EXPECT_TRUE(other.expired());
  EXPECT_FALSE(seen.expired());
}

}  // namespace
}  // namespace mebots::world::camera
