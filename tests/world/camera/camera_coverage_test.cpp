// SPDX-License-Identifier: Apache-2.0
#include "camera_scenes.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

namespace mebots::world::camera {
namespace {

using Eigen::Vector3d;
using testing::Picture;
using testing::pose;

constexpr int kSize = 96;
constexpr double kFocal_px = 50.0;

/// Counts how often each pixel is covered.
class Counter {
 public:
  /// `corners_C` must be counter-clockwise as seen from the camera.
  void add(const std::vector<Vector3d>& corners_C) {
    std::array<Outline::Edge, kMaxOutlineCorners> edges;
    const Outline outline({kFocal_px, kSize, kSize}, corners_C, edges);
    for (int first = 0; first < kSize; first += Outline::kStripRows) {
      outline.spans(first, first + Outline::kStripRows, [&](int row, int begin, int end) {
        for (int column = begin; column < end; ++column) ++counts_[static_cast<std::size_t>(row) * kSize + column];
      });
    }
  }
  int at(int column, int row) const { return counts_[static_cast<std::size_t>(row) * kSize + column]; }
  bool all(int expected) const {
    return std::all_of(counts_.begin(), counts_.end(), [=](int count) { return count == expected; });
  }
  int total() const {
    int sum = 0;
    for (const int count : counts_) sum += count;
    return sum;
  }

 private:
  std::vector<int> counts_ = std::vector<int>(static_cast<std::size_t>(kSize) * kSize, 0);
};

/// Returns the point at a depth that appears at a pixel.
Vector3d behind_pixel(double x_px, double y_px, double depth = 1.0) {
  return depth * Vector3d(1.0, (0.5 * kSize - x_px) / kFocal_px, (0.5 * kSize - y_px) / kFocal_px);
}

TEST(CameraCoverage, PixelCentresOnLeftAndTopEdgesBelongToTheFaceOthersDoNot) {
  Counter counter;
  counter.add({behind_pixel(10.5, 20.5), behind_pixel(10.5, 30.5), behind_pixel(15.5, 30.5), behind_pixel(15.5, 20.5)});
  EXPECT_EQ(counter.total(), 50);
  EXPECT_EQ(counter.at(10, 20), 1);
  EXPECT_EQ(counter.at(14, 29), 1);
  EXPECT_EQ(counter.at(15, 20), 0);
  EXPECT_EQ(counter.at(10, 30), 0);
}

TEST(CameraCoverage, FacesSeenFromBehindCoverNothing) {
  Counter counter;
  counter.add({behind_pixel(10, 20), behind_pixel(30, 20), behind_pixel(30, 40), behind_pixel(10, 40)});
  EXPECT_EQ(counter.total(), 0);
}

TEST(CameraCoverage, TrianglesOfAMeshCoverEachPixelExactlyOnce) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> jitter(-2.8, 2.8);
  std::uniform_real_distribution<double> depth(0.5, 3.0);
  for (int round = 0; round < 50; ++round) {
    // A grid of points in and around the picture. Each point has a random depth, and is shifted at random by less than
    // half the spacing, so that the grid does not fold.
    std::array<std::array<Vector3d, 11>, 11> mesh;
    for (int j = 0; j < 11; ++j) {
      for (int i = 0; i < 11; ++i) {
        mesh[j][i] = behind_pixel(12.0 * i - 12.0 + jitter(random), 12.0 * j - 12.0 + jitter(random), depth(random));
      }
    }
    Counter counter;
    for (int j = 0; j < 10; ++j) {
      for (int i = 0; i < 10; ++i) {
        const Vector3d &a = mesh[j][i], &b = mesh[j + 1][i], &c = mesh[j + 1][i + 1], &d = mesh[j][i + 1];
        if (random() % 2 == 0) {
          counter.add({a, b, c});
          counter.add({a, c, d});
        } else {
          counter.add({b, c, d});
          counter.add({b, d, a});
        }
      }
    }
    EXPECT_TRUE(counter.all(1)) << "round " << round;
  }
}

TEST(CameraCoverage, TrianglesThroughTheCamerasPlaneLeaveNoHole) {
  // The ground reaches from far behind the camera to far in front of it. Random strips and triangles divide it. All
  // pixels below the horizon must be covered once, and no pixel above the horizon.
  std::mt19937 random(5);
  std::uniform_real_distribution<double> anywhere(-3.0, 3.0);
  for (int round = 0; round < 50; ++round) {
    std::vector<double> cuts{-1000.0, 1000.0, 0.0};
    for (int i = 0; i < 8; ++i) cuts.push_back(anywhere(random));
    std::sort(cuts.begin(), cuts.end());
    std::vector<Vector3d> left;
    std::vector<Vector3d> right;
    for (const double x : cuts) left.emplace_back(x, 900.0 + anywhere(random), -0.02);
    for (double& x : cuts) x += 0.1 * anywhere(random);
    std::sort(cuts.begin(), cuts.end());
    for (const double x : cuts) right.emplace_back(x, -900.0, -0.02);
    Counter counter;
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
      counter.add({right[i], right[i + 1], left[i + 1]});
      counter.add({right[i], left[i + 1], left[i]});
    }
    for (int row = 0; row < kSize; ++row) {
      for (int column = 0; column < kSize; ++column) {
        ASSERT_EQ(counter.at(column, row), row >= kSize / 2 ? 1 : 0)
            << "round " << round << ", " << column << ", " << row;
      }
    }
  }
}

TEST(CameraCoverage, RowsOfAStripAreThoseTakenOneByOne) {
  // For several rows, spans() computes each row's columns from those of the previous row. For a single row, it computes
  // them by divisions. Both must give the same columns.
  std::mt19937 random(13);
  std::uniform_real_distribution<double> place(-1.0, 1.0);
  std::uniform_real_distribution<double> exponent(-1.0, 14.0);
  using Spans = std::vector<std::array<int, 3>>;
  std::size_t compared = 0;
  for (int round = 0; round < 20000; ++round) {
    const double reach_px = std::exp2(exponent(random));  // from less than a pixel to far outside of the picture
    const double x_px = 0.5 * kSize * (1.0 + place(random));
    const double y_px = 0.5 * kSize * (1.0 + place(random));
    std::vector<Vector3d> corners;
    for (int i = 0; i < 3; ++i)
      corners.push_back(behind_pixel(x_px + reach_px * place(random), y_px + reach_px * place(random)));
    std::array<Outline::Edge, kMaxOutlineCorners> edges;
    const Outline outline({kFocal_px, kSize, kSize}, corners, edges);
    Spans in_strips;
    Spans one_by_one;
    for (int first = 0; first < kSize; first += Outline::kStripRows) {
      outline.spans(first, first + Outline::kStripRows, [&](int row, int begin, int end) {
        in_strips.push_back({row, begin, end});
      });
    }
    for (int row = 0; row < kSize; ++row)
      outline.spans(row, row + 1, [&](int, int begin, int end) { one_by_one.push_back({row, begin, end}); });
    ASSERT_EQ(in_strips, one_by_one) << "round " << round;
    compared += in_strips.size();
  }
  EXPECT_GT(compared, 100000U);
}

Geometry one_face(const Face& face) {
  Geometry geometry;
  geometry.tiles.push_back(shared_tile(testing::patterned(scene::Texture::Kind::noise, 250.0, 20.0, 0.05)));
  geometry.background = 3.0;
  geometry.faces.push_back(face);
  return geometry;
}

/// Splits triangles at random points until there are `count` triangles.
std::vector<Face> cut_up(const Face& quad, int count, std::mt19937& random) {
  std::uniform_real_distribution<double> share(0.1, 1.0);
  std::vector<Face> pieces(2, quad);
  const auto& c = quad.corners_W_m;
  pieces[0].corners_W_m = {c[0], c[1], c[2]};
  pieces[1].corners_W_m = {c[0], c[2], c[3]};
  while (static_cast<int>(pieces.size()) < count) {
    const std::size_t which = random() % pieces.size();
    const auto corners = pieces[which].corners_W_m;
    const double a = share(random);
    const double b = share(random);
    const double d = share(random);
    const Vector3d inside = (a * corners[0] + b * corners[1] + d * corners[2]) / (a + b + d);
    pieces[which].corners_W_m = {corners[0], corners[1], inside};
    pieces.push_back(pieces[which]);
    pieces.back().corners_W_m = {corners[1], corners[2], inside};
    pieces.push_back(pieces[which]);
    pieces.back().corners_W_m = {corners[2], corners[0], inside};
  }
  std::shuffle(pieces.begin(), pieces.end(), random);
  return pieces;
}

TEST(CameraCoverage, AFaceCutIntoRandomTrianglesLooksTheSameToTheByte) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> anywhere(-1.0, 1.0);
  for (int round = 0; round < 30; ++round) {
    // The camera is anywhere in front of the wall. Parts of the wall may be behind the camera.
    Face wall;
    wall.normal_W = -Vector3d::UnitX();
    wall.offset_m = -1.0;
    wall.u_axis_W = -Vector3d::UnitY();
    wall.v_axis_W = Vector3d::UnitZ();
    wall.texture_origin_W_m = {1.0, 0.0, 0.0};
    wall.corners_W_m = {{1.0, 3.0 + anywhere(random), -2.0 + anywhere(random)},
                        {1.0, -3.0 + anywhere(random), -2.0 + anywhere(random)},
                        {1.0, -3.0 + anywhere(random), 2.0 + anywhere(random)},
                        {1.0, 3.0 + anywhere(random), 2.0 + anywhere(random)}};
    const Pose from = pose({0.5 * anywhere(random) + 0.4, anywhere(random), anywhere(random)}, 1.2 * anywhere(random),
                           0.5 * anywhere(random), 3.0 * anywhere(random));
    Geometry whole = one_face(wall);
    Geometry pieces = whole;
    pieces.faces = cut_up(wall, 40, random);
    Renderer of_whole(whole, {}, 0.0);
    Renderer of_pieces(pieces, {}, 0.0);
    EXPECT_EQ(testing::differing_pixels(testing::picture(of_whole, from), testing::picture(of_pieces, from)), 0)
        << "round " << round;
  }
}

TEST(CameraCoverage, EveryPixelIsWritten) {
  Renderer renderer(testing::patterned_room(), {}, 0.0);
  for (const Pose& from : testing::awkward_poses()) {
    std::vector<std::uint8_t> on_black(320 * 320, 0);
    std::vector<std::uint8_t> on_white(320 * 320, 255);
    renderer.render(from, 1, 0, on_black);
    renderer.render(from, 1, 0, on_white);
    EXPECT_EQ(on_black, on_white);
  }
}

TEST(CameraCoverage, AGateCoversThePixelsOfItsFourBeams) {
  const scene::Scene with_gates = testing::room();
  scene::Scene with_beams = with_gates;
  with_beams.gates.clear();
  for (const scene::Gate& gate : with_gates.gates) {
    for (const scene::Box& beam : gate.beams()) with_beams.boxes.push_back(beam);
  }
  Renderer of_gates(with_gates, {}, 0.0);
  Renderer of_beams(with_beams, {}, 0.0);
  for (const Pose& from : testing::awkward_poses()) {
    // Permits a few different pixels. Separate beams may leave a crack of 1/4096 pixel at their joint. The gate's faces
    // have other corners than separate beams, so their edges are rounded differently.
    EXPECT_LE(testing::differing_pixels(testing::picture(of_gates, from), testing::picture(of_beams, from)), 3);
  }
}

TEST(CameraCoverage, NoCornerOfAGateLiesInTheMiddleOfAnotherFacesEdge) {
  // If a corner is in the middle of another face's edge, rounding can move the corner away from this edge. The
  // background is then visible in the gap.
  scene::Scene scene = testing::room();
  scene.boxes.clear();
  const Geometry geometry = make_geometry(scene);
  ASSERT_EQ(geometry.faces.size(), 1U + 2U * 16U);
  for (std::size_t i = 1; i < geometry.faces.size(); ++i) {
    const auto& ring = geometry.faces[i].corners_W_m;
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const Vector3d& a = ring[k];
      const Vector3d along = ring[(k + 1) % ring.size()] - a;
      for (std::size_t j = 1; j < geometry.faces.size(); ++j) {
        for (const Vector3d& p : geometry.faces[j].corners_W_m) {
          const double share = along.dot(p - a) / along.squaredNorm();
          const bool between = share > 1e-6 && share < 1.0 - 1e-6;
          EXPECT_FALSE(between && (p - a - share * along).norm() < 1e-9) << "faces " << i << " and " << j;
        }
      }
    }
  }
}

}  // namespace
}  // namespace mebots::world::camera
