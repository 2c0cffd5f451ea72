// SPDX-License-Identifier: Apache-2.0
#include "camera_scenes.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace mebots::world::camera {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using testing::Picture;
using testing::pose;

/// Returns a scene in which only the gate's front is white. The sun is the only light, and is in front of the gate.
scene::Scene white_front(const scene::Gate& gate) {
  scene::Scene scene = testing::dark_scene();
  scene.lighting.ambient = 0.0;
  scene.lighting.sun = 1.0;
  scene.lighting.to_sun_W = -Vector3d(std::cos(gate.yaw_rad), std::sin(gate.yaw_rad), 0.0);
  scene.gates = {gate};
  scene.gates[0].texture = testing::uniform(255.0);
  return scene;
}

/// Returns the corners of a square with this edge in the plane of the gate's front, in order.
std::array<Vector3d, 4> front_square(const scene::Gate& gate, double edge_m) {
  const Vector3d x(std::cos(gate.yaw_rad), std::sin(gate.yaw_rad), 0.0);
  const Vector3d y(-std::sin(gate.yaw_rad), std::cos(gate.yaw_rad), 0.0);
  const Vector3d middle = gate.p_W_m - 0.5 * gate.thickness_m * x;
  const double h = 0.5 * edge_m;
  return {middle + h * y + h * Vector3d::UnitZ(), middle - h * y + h * Vector3d::UnitZ(),
          middle - h * y - h * Vector3d::UnitZ(), middle + h * y - h * Vector3d::UnitZ()};
}

struct Line {
  Vector2d point, direction;
};

/// Returns the straight edge between black and white near the segment a-b, fitted to the transitions in the picture.
Line fitted_edge(const Picture& seen, const Vector2d& a, const Vector2d& b) {
  const bool steep = std::abs(b.y() - a.y()) > std::abs(b.x() - a.x());
  const int along = steep ? 1 : 0;
  const int across = 1 - along;
  const double low = std::min(a[along], b[along]);
  const double high = std::max(a[along], b[along]);
  const double margin = 0.05 * (high - low);
  double n = 0, st = 0, ss = 0, stt = 0, sts = 0;
  for (int i = static_cast<int>(std::ceil(low + margin)); i + 1 < high - margin; ++i) {
    const double t = i + 0.5;
    const double expected = a[across] + (b[across] - a[across]) * (t - a[along]) / (b[along] - a[along]);
    for (int j = static_cast<int>(expected) - 5; j < expected + 5; ++j) {
      const int here = steep ? seen.at(j, i) : seen.at(i, j);
      const int next = steep ? seen.at(j + 1, i) : seen.at(i, j + 1);
      if (here == next) continue;
      const double s = j + 1.0;
      n += 1, st += t, ss += s, stt += t * t, sts += t * s;
      break;
    }
  }
  const double slope = (n * sts - st * ss) / (n * stt - st * st);
  const double at_0 = (ss - slope * st) / n;
  Line line;
  line.point[along] = 0.0;
  line.point[across] = at_0;
  line.direction[along] = 1.0;
  line.direction[across] = slope;
  return line;
}

Vector2d crossing(const Line& a, const Line& b) {
  const Vector2d gap = b.point - a.point;
  const double determinant = a.direction.x() * b.direction.y() - a.direction.y() * b.direction.x();
  const double t = (gap.x() * b.direction.y() - gap.y() * b.direction.x()) / determinant;
  return a.point + t * a.direction;
}

TEST(CameraProjection, CornersOfAGateLandOnTheirAnalyticPixels) {
  scene::Gate gate;
  gate.p_W_m = {2.0, 0.1, 1.03};
  gate.yaw_rad = 0.15;
  const Intrinsics intrinsics{1024, 800, 1.51844};
  Renderer renderer(white_front(gate), intrinsics, 0.0);
  for (const Pose& from : {pose({0.9, 0.2, 1.1}, 0.05, 0.03, 0.12), pose({0.2, -0.3, 0.8}, 0.3, -0.2, -0.35)}) {
    const Picture seen = testing::picture(renderer, from);
    for (const double edge_m : {gate.outer_m, gate.inner_m}) {
      std::array<Vector2d, 4> expected;
      for (int i = 0; i < 4; ++i) expected[i] = testing::projected(front_square(gate, edge_m)[i], from, intrinsics);
      for (int i = 0; i < 4; ++i) {
        const Line before = fitted_edge(seen, expected[(i + 3) % 4], expected[i]);
        const Line after = fitted_edge(seen, expected[i], expected[(i + 1) % 4]);
        // Each point of a fitted line is known to one pixel, with a standard deviation of 0.29. A line through more
        // than 80 points has an error of about 0.29 * 2 / sqrt(80) = 0.06 pixel (one sigma) at its end.
        EXPECT_LT((crossing(before, after) - expected[i]).norm(), 0.2) << "edge " << edge_m << " m, corner " << i;
      }
    }
  }
}

TEST(CameraProjection, AreaOfAGateFrontIsItsProjectedArea) {
  scene::Gate gate;
  gate.p_W_m = {2.0, 0.1, 1.03};
  gate.yaw_rad = 0.15;
  const Intrinsics intrinsics{1024, 800, 1.51844};
  Renderer renderer(white_front(gate), intrinsics, 0.0);
  const Pose from = pose({0.9, 0.2, 1.1}, 0.05, 0.03, 0.12);
  const auto area = [&](double edge_m) {
    double twice = 0.0;
    for (int i = 0; i < 4; ++i) {
      const Vector2d a = testing::projected(front_square(gate, edge_m)[i], from, intrinsics);
      const Vector2d b = testing::projected(front_square(gate, edge_m)[(i + 1) % 4], from, intrinsics);
      twice += a.x() * b.y() - a.y() * b.x();
    }
    return 0.5 * std::abs(twice);
  };
  const Picture seen = testing::picture(renderer, from);
  const auto white = std::count(seen.pixels.begin(), seen.pixels.end(), 255);
  // About 2000 pixels at the boundary are inside or outside at random: 0.29 sqrt(2000) = 13 pixels (one sigma).
  EXPECT_NEAR(static_cast<double>(white), area(gate.outer_m) - area(gate.inner_m), 50.0);
}

/// Returns the position closest to `near` at which a row of grey levels crosses `middle`, in either direction.
/// Interpolates between two pixels.
std::optional<double> transition(const std::vector<double>& grey, double middle, double near) {
  std::optional<double> best;
  for (std::size_t i = 0; i + 1 < grey.size(); ++i) {
    if ((grey[i] < middle) == (grey[i + 1] < middle)) continue;
    const double at = static_cast<double>(i) + 0.5 + (middle - grey[i]) / (grey[i + 1] - grey[i]);
    if (!best || std::abs(at - near) < std::abs(*best - near)) best = at;
  }
  return best;
}

TEST(CameraProjection, CheckersOnTheGroundChangeWherePerspectivePutsThem) {
  constexpr double kScale = 0.5;
  scene::Scene scene = testing::dark_scene();
  scene.ground.texture = testing::patterned(scene::Texture::Kind::checker, 200.0, 50.0, kScale);
  const Intrinsics intrinsics;
  const double f = intrinsics.focal_length_px();
  Renderer renderer(scene, intrinsics, 0.0);
  const Pose from = pose({0.13, 0.21, 1.0});
  const Picture seen = testing::picture(renderer, from);

  // Tests a pixel column. It crosses the edges x = k kScale between squares, where the grey level changes. Crossings
  // near an edge y = k kScale are skipped.
  const int column = 165;
  const double lateral_per_depth = -(column + 0.5 - 160.0) / f;
  std::vector<double> down(320);
  for (int row = 0; row < 320; ++row) down[row] = seen.at(column, row);
  int checked = 0;
  for (int k = 3; k <= 9; ++k) {
    const double depth = k * kScale - from.p_WC_m.x();
    const double y = (from.p_WC_m.y() + lateral_per_depth * depth) / kScale;
    if (std::abs(y - std::round(y)) < 0.15) continue;
    const double expected = 160.0 + f * from.p_WC_m.z() / depth;
    const auto found = transition(down, 125.0, expected);
    ASSERT_TRUE(found);
    // A pixel covers up to a tenth of a square's edge. transition() interpolates between two pixels, so its result may
    // be wrong by a part of a pixel.
    EXPECT_NEAR(*found, expected, 0.3) << "line x = " << k * kScale;
    ++checked;
  }
  EXPECT_GE(checked, 5);

  // Tests pixel rows, which cross the edges y = k kScale between squares.
  checked = 0;
  for (const int row : {200, 230, 260, 290, 319}) {
    const double depth = f * from.p_WC_m.z() / (row + 0.5 - 160.0);
    const double x = (from.p_WC_m.x() + depth) / kScale;
    if (std::abs(x - std::round(x)) < 0.15) continue;
    std::vector<double> across(320);
    for (int i = 0; i < 320; ++i) across[i] = seen.at(i, row);
    for (int k = -6; k <= 6; ++k) {
      const double expected = 160.0 - f * (k * kScale - from.p_WC_m.y()) / depth;
      if (expected < 3.0 || expected > 317.0) continue;
      const auto found = transition(across, 125.0, expected);
      ASSERT_TRUE(found);
      EXPECT_NEAR(*found, expected, 0.3) << "row " << row << ", line y = " << k * kScale;
      ++checked;
    }
  }
  EXPECT_GE(checked, 15);
}

/// Returns the grey level of the surface that a ray from `origin` meets. Intersects the solids directly (slabs) in
/// double precision, without the renderer's code.
class RayCaster {
 public:
  explicit RayCaster(const scene::Scene& scene) : scene_(scene), boxes_(scene.boxes) {
    for (const scene::Gate& gate : scene.gates) {
      for (const scene::Box& beam : gate.beams()) boxes_.push_back(beam);
    }
  }

  double grey(const Vector3d& origin, const Vector3d& ray) const {
    double nearest = std::numeric_limits<double>::infinity();
    double result = scene_.lighting.background;
    const double t_ground = -origin.z() / ray.z();
    const Vector3d hit = origin + t_ground * ray;
    const double half = scene_.ground.half_size_m;
    if (ray.z() < 0.0 && std::abs(hit.x()) <= half && std::abs(hit.y()) <= half) {
      nearest = t_ground;
      result = scene_.ground.texture.light * light(Vector3d::UnitZ());
    }
    for (const scene::Box& box : boxes_) {
      const double c = std::cos(box.yaw_rad);
      const double s = std::sin(box.yaw_rad);
      const auto into_box = [&](const Vector3d& v) {
        return Vector3d(c * v.x() + s * v.y(), c * v.y() - s * v.x(), v.z());
      };
      const Vector3d o = into_box(origin - box.p_W_m);
      const Vector3d d = into_box(ray);
      double enter = 0.0;
      double leave = nearest;
      int axis = -1;
      for (int k = 0; k < 3; ++k) {
        const double t1 = (-0.5 * box.size_m[k] - o[k]) / d[k];
        const double t2 = (0.5 * box.size_m[k] - o[k]) / d[k];
        if (std::min(t1, t2) > enter) enter = std::min(t1, t2), axis = k;
        leave = std::min(leave, std::max(t1, t2));
      }
      if (axis < 0 || enter >= leave) continue;
      nearest = enter;
      Vector3d normal = Vector3d::Zero();
      normal[axis] = d[axis] > 0.0 ? -1.0 : 1.0;
      const Vector3d normal_W(c * normal.x() - s * normal.y(), s * normal.x() + c * normal.y(), normal.z());
      result = box.texture.light * light(normal_W);
    }
    return result;
  }

 private:
  double light(const Vector3d& normal) const {
    return scene_.lighting.ambient + scene_.lighting.sun * std::max(0.0, normal.dot(scene_.lighting.to_sun_W));
  }

  scene::Scene scene_;
  std::vector<scene::Box> boxes_;
};

TEST(CameraProjection, EveryPixelSeesWhatARayThroughItsCentreMeets) {
  const scene::Scene scene = testing::room();
  const RayCaster caster(scene);
  const Intrinsics intrinsics;
  const double f = intrinsics.focal_length_px();
  Renderer renderer(scene, intrinsics, 0.0);
  int place = 0;
  for (const Pose& from : testing::awkward_poses()) {
    const Picture seen = testing::picture(renderer, from);
    int wrong = 0;
    for (int row = 0; row < 320; ++row) {
      for (int column = 0; column < 320; ++column) {
        const Vector3d ray = from.R_WC * Vector3d(1.0, (159.5 - column) / f, (159.5 - row) / f);
        const double expected = caster.grey(from.p_WC_m, ray);
        wrong += std::abs(seen.at(column, row) - expected) > 0.51 ? 1 : 0;
      }
    }
    // Corners are rounded to 1/4096 pixel, so about one of 3000 edge pixels may be on the other side. If the camera
    // almost touches a face, single precision affects a few more.
    EXPECT_LE(wrong, 8) << "pose " << place;
    ++place;
  }
}

TEST(CameraProjection, PatternOfASlantedWallLiesWhereRaysMeetIt) {
  constexpr double kScale = 0.25;
  scene::Scene scene = testing::dark_scene();
  const scene::Box wall{"wall",
                        {2.0, 0.0, 1.5},
                        {0.2, 6.0, 3.0},
                        0.9,
                        testing::patterned(scene::Texture::Kind::checker, 200.0, 50.0, kScale)};
  scene.boxes = {wall};
  const Intrinsics intrinsics;
  const double f = intrinsics.focal_length_px();
  Renderer renderer(scene, intrinsics, 0.0);
  for (const Pose& from : {pose({0.3, -0.6, 1.2}, 0.1, 0.1, 0.5), pose({0.0, 0.5, 0.7}, -0.3, -0.4, -1.1)}) {
    // Returns the wall's grey level at a position in the picture: 200 or 50 if the ray meets the side towards the
    // camera, otherwise 0.
    const auto expected = [&](double x_px, double y_px) {
      const Vector3d ray = from.R_WC * Vector3d(1.0, (160.0 - x_px) / f, (160.0 - y_px) / f);
      const Vector3d x(std::cos(wall.yaw_rad), std::sin(wall.yaw_rad), 0.0);
      const Vector3d y(-std::sin(wall.yaw_rad), std::cos(wall.yaw_rad), 0.0);
      const double depth = (wall.p_W_m - 0.1 * x - from.p_WC_m).dot(x) / ray.dot(x);
      const Vector3d hit = from.p_WC_m + depth * ray - wall.p_W_m;
      const double u = 3.0 - hit.dot(y);  // from the left, as seen from outside
      const double v = hit.z() + 1.5;
      if (depth < 0.0 || u < 0.0 || u > 6.0 || v < 0.0 || v > 3.0) return 0;
      return static_cast<int>(u / kScale) % 2 == static_cast<int>(v / kScale) % 2 ? 200 : 50;
    };
    const Picture seen = testing::picture(renderer, from);
    int compared = 0;
    for (int row = 3; row < 317; ++row) {
      for (int column = 3; column < 317; ++column) {
        const int middle = expected(column + 0.5, row + 0.5);
        // Skips pixels near a line between squares, because they are averages.
        bool plain = middle > 0;
        for (const int dx : {-3, 0, 3}) {
          for (const int dy : {-3, 0, 3}) plain = plain && expected(column + 0.5 + dx, row + 0.5 + dy) == middle;
        }
        if (!plain) continue;
        ++compared;
        ASSERT_EQ(seen.at(column, row), middle) << column << ", " << row;
      }
    }
    EXPECT_GT(compared, 10000);
  }
}

TEST(CameraProjection, PatternOfAGateBeginsAtItsLowerLeftCornerOnBothFaces) {
  scene::Scene scene = testing::dark_scene();
  scene::Gate gate;
  gate.p_W_m = {2.0, 0.0, 1.0};
  gate.texture = testing::patterned(scene::Texture::Kind::stripes, 200.0, 50.0, 0.2);  // light, dark, light
  scene.gates = {gate};
  Renderer renderer(scene, {}, 0.0);
  for (const Pose& from : {pose({1.0, 0.0, 1.0}), pose({3.0, 0.0, 1.0}, M_PI)}) {
    const Picture seen = testing::picture(renderer, from);
    const double pixels_per_m = Intrinsics{}.focal_length_px() / 0.985;
    const int top = static_cast<int>(160 - 0.25 * pixels_per_m);
    EXPECT_EQ(seen.at(static_cast<int>(160 - 0.25 * pixels_per_m), 160), 200);
    EXPECT_EQ(seen.at(160, top), 50);
    EXPECT_EQ(seen.at(static_cast<int>(160 + 0.25 * pixels_per_m), 160), 200);
  }
}

TEST(CameraProjection, PositivePitchOfTheMountingLooksDown) {
  const Mounting mounting{{0.027, 0.0, 0.012}, 0.3};
  const Eigen::Matrix3d R_WB = pose(Vector3d::Zero(), 0.5).R_WC;
  const Pose from = camera_pose(mounting, {1.0, 2.0, 1.0}, R_WB);
  const Vector3d axis_W = from.R_WC.col(0);
  EXPECT_NEAR(axis_W.z(), -std::sin(0.3), 1e-15);
  EXPECT_NEAR(std::atan2(axis_W.y(), axis_W.x()), 0.5, 1e-15);
  EXPECT_NEAR((from.p_WC_m - Vector3d(1.0 + 0.027 * std::cos(0.5), 2.0 + 0.027 * std::sin(0.5), 1.012)).norm(), 0.0,
              1e-15);
}

TEST(CameraProjection, HorizonOfALevelCameraIsInTheMiddle) {
  scene::Scene scene = testing::dark_scene();
  scene.ground.half_size_m = 5000.0;
  scene.ground.texture = testing::uniform(100.0);
  scene.lighting.background = 200.0;
  Renderer renderer(scene, {}, 0.0);
  const Picture seen = testing::picture(renderer, pose({0.0, 0.0, 1.0}, 0.7));
  for (int column = 0; column < 320; ++column) {
    EXPECT_EQ(seen.at(column, 159), 200);
    EXPECT_EQ(seen.at(column, 160), 100);
  }
}

}  // namespace
}  // namespace mebots::world::camera
