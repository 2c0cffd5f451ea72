// SPDX-License-Identifier: Apache-2.0
#include "scene/scene.hpp"

#include "mebots/assert.hpp"

#include <algorithm>
#include <cmath>

namespace mebots::world::scene {

std::array<Box, 4> Gate::beams() const {
  const double side = 0.5 * (outer_m - inner_m);
  const double sill = 0.5 * (frame_height_m() - opening_height_m());
  const double across = 0.25 * (outer_m + inner_m);
  const double up = 0.25 * (frame_height_m() + opening_height_m());
  const bool upright = pitch_rad == 0.0 && roll_rad == 0.0;
  const Eigen::Matrix3d R_WG = attitude_of(*this).toRotationMatrix();
  const Eigen::Vector3d left_W =
      upright ? Eigen::Vector3d{-std::sin(yaw_rad), std::cos(yaw_rad), 0.0} : Eigen::Vector3d(R_WG.col(1));
  const Eigen::Vector3d up_W = upright ? Eigen::Vector3d(Eigen::Vector3d::UnitZ()) : Eigen::Vector3d(R_WG.col(2));
  const auto beam = [&](const char* which, const Eigen::Vector3d& offset_W, double along_y, double along_z) {
    return Box{name + " " + which,
               p_W_m + offset_W,
               {thickness_m, along_y, along_z},
               yaw_rad,
               texture,
               pitch_rad,
               roll_rad,
               {}};
  };
  return {beam("left", across * left_W, side, frame_height_m()),
          beam("right", -across * left_W, side, frame_height_m()), beam("top", up * up_W, inner_m, sill),
          beam("bottom", -up * up_W, inner_m, sill)};
}

double Path::reach_m() const {
  double reach_m = 0.0;
  for (const Point& point : points) reach_m = std::max(reach_m, point.offset_W_m.norm());
  return reach_m;
}

Displacement Path::at(std::int64_t time_ns) const {
  if (!moves()) return {};
  MEBOTS_ASSERT(points.size() >= 2 && points.front().time_ns == 0);
  const std::int64_t end_ns = points.back().time_ns;
  // Uses whole nanoseconds, so that every repetition is exact.
  const std::int64_t now_ns = repeat ? std::max<std::int64_t>(time_ns, 0) % end_ns : std::max<std::int64_t>(time_ns, 0);
  if (now_ns >= end_ns) return {points.back().offset_W_m, points.back().turn_rad, Eigen::Vector3d::Zero(), 0.0};
  const auto next = std::upper_bound(points.begin() + 1, points.end(), now_ns,
                                     [](std::int64_t time, const Point& point) { return time < point.time_ns; });
  const Point& a = *(next - 1);
  const Point& b = *next;
  const double span_s = static_cast<double>(b.time_ns - a.time_ns) * 1e-9;
  const double share = static_cast<double>(now_ns - a.time_ns) / static_cast<double>(b.time_ns - a.time_ns);
  const Eigen::Vector3d way_m = b.offset_W_m - a.offset_W_m;
  const double turn_rad = b.turn_rad - a.turn_rad;
  return {a.offset_W_m + share * way_m, a.turn_rad + share * turn_rad, way_m / span_s, turn_rad / span_s};
}

namespace {

template <typename Thing>
Solid placed(const Thing& thing, Solid::Shape shape) {
  Solid solid;
  solid.shape = shape;
  solid.name = thing.name;
  solid.p_W_m = thing.p_W_m;
  solid.q_W = attitude_of(thing);
  return solid;
}

Solid solid_of(const Box& box) {
  Solid solid = placed(box, Solid::Shape::box);
  solid.size_m = box.size_m;
  solid.radius_m = 0.5 * box.size_m.norm();
  solid.path = box.path;
  return solid;
}

Solid solid_of(const Cylinder& cylinder) {
  Solid solid = placed(cylinder, Solid::Shape::cylinder);
  solid.size_m = {2.0 * cylinder.radius_m, 2.0 * cylinder.radius_m, cylinder.height_m};
  solid.radius_m = std::sqrt(cylinder.radius_m * cylinder.radius_m + 0.25 * cylinder.height_m * cylinder.height_m);
  solid.path = cylinder.path;
  return solid;
}

Solid solid_of(const MeshThing& thing) {
  Solid solid = placed(thing, Solid::Shape::mesh);
  solid.mesh = thing.mesh;
  solid.radius_m = thing.mesh->radius_m();
  solid.path = thing.path;
  return solid;
}

template <typename Things>
std::vector<Solid> solids_in(const Things& things) {
  std::vector<Solid> solids;
  for (const Box& box : things.boxes) solids.push_back(solid_of(box));
  for (const Cylinder& cylinder : things.cylinders) solids.push_back(solid_of(cylinder));
  for (const MeshThing& thing : things.meshes) solids.push_back(solid_of(thing));
  return solids;
}

}  // namespace

std::vector<Solid> solids_of(const Robot& robot) {
  return solids_in(robot);
}

std::vector<Solid> solids_of(const Scene& scene) {
  std::vector<Solid> solids = solids_in(scene);
  for (std::size_t i = 0; i < scene.gates.size(); ++i) {
    const Gate& gate = scene.gates[i];
    const std::size_t first = solids.size();
    if (gate.has_beams()) {
      for (const Box& beam : gate.beams()) solids.push_back(solid_of(beam));
    } else {
      solids.push_back(placed(gate, Solid::Shape::mesh));
      solids.back().mesh = std::make_shared<const Mesh>(gate.frame());
      solids.back().radius_m = solids.back().mesh->radius_m();
    }
    for (std::size_t part = first; part < solids.size(); ++part) solids[part].gate = i;
  }
  return solids;
}

}  // namespace mebots::world::scene
