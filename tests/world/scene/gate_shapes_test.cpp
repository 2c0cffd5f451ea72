// SPDX-License-Identifier: Apache-2.0
// Tests gates of all shapes: the volume of their frames, the area of the opening, and whether both are consistent.
#include "dynamics/rigid_world.hpp"
#include "flight/gate_judge.hpp"
#include "scene/scene.hpp"
#include "support/flight_rig.hpp"
#include "support/one_body.hpp"

#include <gtest/gtest.h>
#include <cmath>

namespace mebots::world {
namespace {

using Eigen::Vector3d;
using Shape = scene::Gate::Shape;

scene::Gate gate_of(Shape shape) {
  scene::Gate gate;
  gate.name = "gate";
  gate.shape = shape;
  gate.p_W_m = {1.0, 2.0, 1.5};
  gate.yaw_rad = 0.6;
  gate.inner_m = 0.8;
  gate.outer_m = 1.0;
  gate.inner_height_m = 0.5;
  gate.outer_height_m = 0.7;
  gate.sides = 6;
  return gate;
}

bool crosses(const scene::Gate& gate, double y_m, double z_m) {
  GateJudge judge({GateFrame(gate)}, Vector3d(0.092, 0.092, 0.029));
  const auto q = scene::attitude_of(gate);
  RigidState before;
  before.p_WB_m = gate.p_W_m + q * Vector3d(-0.2, y_m, z_m);
  RigidState behind;
  behind.p_WB_m = gate.p_W_m + q * Vector3d(0.2, y_m, z_m);
  const auto event = judge.move(before, behind);
  return event && event->kind == GateEvent::Kind::crossed;
}

/// True if a small drone at this place of the gate's plane touches the frame. The drone is aligned with the gate.
bool frame_is_at(const scene::Gate& gate, double y_m, double z_m) {
  scene::Scene scene = test::shipped_scene("empty");
  scene.gates = {gate};
  scene.drone.body_size_m = {1e-3, 1e-3, 1e-3};
  test::OneBody bodies(scene);
  RigidState state;
  state.q_WB = scene::attitude_of(gate);
  // Tests at the frame's front face, because a mesh has no interior.
  state.p_WB_m = gate.p_W_m + state.q_WB * Vector3d(-0.5 * gate.thickness_m, y_m, z_m);
  for (const Touch& touch : bodies.touches_at(state)) {
    if (touch.what == Touch::What::gate) return true;
  }
  return false;
}

class GateShape : public testing::TestWithParam<Shape> {};

TEST_P(GateShape, TheOpeningIsFreeOfTheFrameAndTheRestIsNot) {
  scene::Gate gate = gate_of(GetParam());
  gate.pitch_rad = 0.2;
  gate.roll_rad = -0.3;
  int through = 0;
  int framed = 0;
  for (double y = -0.62; y <= 0.62; y += 0.031) {
    for (double z = -0.623; z <= 0.62; z += 0.037) {
      const bool crossed = crosses(gate, y, z);
      const bool held = frame_is_at(gate, y, z);
      EXPECT_FALSE(crossed && held) << y << " " << z;
      through += crossed ? 1 : 0;
      framed += held ? 1 : 0;
    }
  }
  const GateFrame frame(gate);
  // Measures areas by counting points. Each point represents 0.031 x 0.037 m2.
  const double cell_m2 = 0.031 * 0.037;
  const double sides = gate.side_count();
  const auto polygon_m2 = [&](double across_m) { return 0.25 * sides * across_m * across_m * std::tan(M_PI / sides); };
  const bool beams = gate.has_beams();
  const double opening_m2 = beams ? gate.inner_m * gate.opening_height_m() : polygon_m2(gate.inner_m);
  const double outline_m2 = beams ? gate.outer_m * gate.frame_height_m() : polygon_m2(gate.outer_m);
  EXPECT_NEAR(through * cell_m2, opening_m2, 0.07 * outline_m2);
  EXPECT_NEAR(framed * cell_m2, outline_m2 - opening_m2, 0.07 * outline_m2);
}

INSTANTIATE_TEST_SUITE_P(All, GateShape,
                         testing::Values(Shape::square, Shape::rectangle, Shape::circle, Shape::polygon));

TEST(GateShapes, ARectangleIsWideAndLow) {
  const scene::Gate gate = gate_of(Shape::rectangle);
  EXPECT_TRUE(crosses(gate, 0.39, 0.24));
  EXPECT_FALSE(crosses(gate, 0.41, 0.0));
  EXPECT_FALSE(crosses(gate, 0.0, 0.26));
}

TEST(GateShapes, AHexagonRestsOnASide) {
  const scene::Gate gate = gate_of(Shape::polygon);
  EXPECT_TRUE(crosses(gate, 0.0, -0.39));
  EXPECT_FALSE(crosses(gate, 0.0, -0.41));
  const double corner_m = 0.4 / std::cos(M_PI / 6);
  EXPECT_TRUE(crosses(gate, corner_m - 0.01, 0.0));
  EXPECT_FALSE(crosses(gate, corner_m + 0.01, 0.0));
}

TEST(GateShapes, ARingIsClosed) {
  // In a closed surface, each edge occurs once in each direction.
  const scene::Mesh mesh = scene::ring(7, 0.6, 0.8, 0.05, {});
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& triangle : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) edges.emplace_back(triangle.corners[k], triangle.corners[(k + 1) % 3]);
  }
  for (const auto& [a, b] : edges) {
    EXPECT_EQ(std::count(edges.begin(), edges.end(), std::pair(a, b)), 1);
    EXPECT_EQ(std::count(edges.begin(), edges.end(), std::pair(b, a)), 1);
  }
  // By the divergence theorem, the volume is positive only if normals point outwards.
  double volume_m3 = 0.0;
  for (const auto& [corners, material, tiles] : mesh.triangles) {
    volume_m3 += mesh.points_m[corners[0]].dot(mesh.points_m[corners[1]].cross(mesh.points_m[corners[2]])) / 6.0;
  }
  const auto area_m2 = [](double across_m) { return 0.25 * 7 * across_m * across_m * std::tan(M_PI / 7); };
  EXPECT_NEAR(volume_m3, (area_m2(0.8) - area_m2(0.6)) * 0.05, 1e-15);  // rounding of sums of 1e-2 m3
}

}  // namespace
}  // namespace mebots::world
