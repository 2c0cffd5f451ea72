// SPDX-License-Identifier: Apache-2.0
#include "hall.hpp"

#include "clutter.hpp"
#include "paint.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace mebots::training {
namespace {

using Eigen::Vector3d;
using world::scene::Cylinder;
using world::scene::Gate;
using world::scene::Scene;
using world::scene::Texture;

constexpr int kMostThings = 11;
constexpr double kClearOfGate_m = 0.8;

constexpr int kMostClutter = 9;
/// The minimum distance of clutter from a gate. Clutter may be next to a gate, but not in it.
constexpr double kClutterClearOfGate_m = 0.55;
/// The share of cluttered halls that have hedges as walls, under the sky.
constexpr double kOutdoors = 0.2;

Texture frame_paint(Random& random) {
  const double kind = random.unit();
  const double level = kind < 0.4    ? random.between(205.0, 255.0)
                       : kind < 0.55 ? random.between(0.0, 45.0)
                                     : random.between(0.0, 255.0);
  Texture texture;
  texture.light = level;
  texture.dark = level;
  if (random.chance(0.3)) {
    texture.kind = random.chance(0.4)   ? Texture::Kind::checker
                   : random.chance(0.5) ? Texture::Kind::stripes
                                        : Texture::Kind::noise;
    texture.dark = std::clamp(level + random.between(-90.0, 90.0), 0.0, 255.0);
    texture.scale_m = random.between(0.03, 0.3);
    texture.seed = random.word();
  }
  return texture;
}

/// Sets a random shape of a gate. More than half of the gates stay squares.
void random_shape(Random& random, Gate& gate) {
  const double kind = random.unit();
  if (kind < 0.55) return;
  gate.outer_m = random.log_between(0.5, 1.15);
  gate.inner_m = gate.outer_m * random.between(0.65, 0.82);
  if (kind < 0.7) {
    gate.shape = Gate::Shape::rectangle;
    gate.outer_height_m = gate.outer_m * random.between(0.7, 1.3);
    gate.inner_height_m = gate.outer_height_m - (gate.outer_m - gate.inner_m);
  } else if (kind < 0.85) {
    gate.shape = Gate::Shape::circle;
  } else {
    gate.shape = Gate::Shape::polygon;
    gate.sides = 5 + random.below(4);
    gate.roll_rad = random.between(-0.3, 0.3);
  }
}

Gate random_gate(Random& random, bool any_shape, double length_m, double half_width_m) {
  Gate gate;
  gate.name = "gate";
  gate.outer_m = random.chance(0.5) ? random.between(0.54, 0.66) : random.log_between(0.42, 0.9);
  gate.inner_m = gate.outer_m * random.between(0.6, 0.75);
  if (any_shape) random_shape(random, gate);
  gate.thickness_m = random.between(0.02, 0.08);
  gate.p_W_m = {random.between(0.0, length_m - 2.6), random.between(0.8 - half_width_m, half_width_m - 0.8),
                random.between(0.65, 1.7)};
  gate.yaw_rad = random.between(-M_PI, M_PI);
  gate.texture = frame_paint(random);
  return gate;
}

Cylinder column(Random& random, double length_m, double half_width_m) {
  Cylinder cylinder;
  cylinder.name = "column";
  cylinder.radius_m = random.between(0.05, 0.4);
  cylinder.height_m = random.between(0.4, 3.0);
  cylinder.p_W_m = {random.between(-1.5, length_m - 2.5), random.between(-half_width_m, half_width_m),
                    0.5 * cylinder.height_m};
  cylinder.texture = random_paint(random, random.between(20.0, 235.0));
  return cylinder;
}

/// True if an object with the half diagonal `reach_m` is too far from the gates to hide a gate from every side.
bool keeps_away(const Scene& scene, const Vector3d& p_W, double reach_m, double clear_m = kClearOfGate_m) {
  return std::all_of(scene.gates.begin(), scene.gates.end(),
                     [&](const Gate& gate) { return (p_W - gate.p_W_m).head<2>().norm() >= clear_m + reach_m; });
}

/// Returns a second gate after the first gate, in about the same direction.
Gate next_gate(Random& random, const Gate& first, double length_m, double half_width_m) {
  Gate gate = random_gate(random, true, length_m, half_width_m);
  gate.yaw_rad = first.yaw_rad + random.between(-0.4, 0.4);
  const double ahead = random.between(2.0, 5.0);
  const double left = random.between(-1.5, 1.5);
  gate.p_W_m.x() = first.p_W_m.x() + ahead * std::cos(first.yaw_rad) - left * std::sin(first.yaw_rad);
  gate.p_W_m.y() = first.p_W_m.y() + ahead * std::sin(first.yaw_rad) + left * std::cos(first.yaw_rad);
  return gate;
}

/// Returns the largest distance of a mesh's points from the vertical line through its origin.
double reach_m(const world::scene::MeshThing& thing) {
  double reach = 0.0;
  for (const auto& point : thing.mesh->points_m) reach = std::max(reach, point.head<2>().norm());
  return reach;
}

/// True if all objects that are in `with` but not in `before` are far enough from the gates.
bool clear_of_gates(const Scene& before, const Scene& with) {
  const auto boxes_keep = std::all_of(
      with.boxes.begin() + static_cast<std::ptrdiff_t>(before.boxes.size()), with.boxes.end(), [&](const auto& box) {
        return keeps_away(with, box.p_W_m, 0.5 * box.size_m.template head<2>().norm(), kClutterClearOfGate_m);
      });
  const auto cylinders_keep = std::all_of(
      with.cylinders.begin() + static_cast<std::ptrdiff_t>(before.cylinders.size()), with.cylinders.end(),
      [&](const auto& cylinder) { return keeps_away(with, cylinder.p_W_m, cylinder.radius_m, kClutterClearOfGate_m); });
  const auto meshes_keep = std::all_of(
      with.meshes.begin() + static_cast<std::ptrdiff_t>(before.meshes.size()), with.meshes.end(),
      [&](const auto& thing) { return keeps_away(with, thing.p_W_m, reach_m(thing), kClutterClearOfGate_m); });
  return boxes_keep && cylinders_keep && meshes_keep;
}

void add_things(Random& random, double length_m, double half_width_m, Scene& scene) {
  const int things = random.below(kMostThings);
  for (int i = 0; i < things; ++i) {
    if (random.chance(0.25)) {
      const Cylinder thing = column(random, length_m, half_width_m);
      if (keeps_away(scene, thing.p_W_m, thing.radius_m)) scene.cylinders.push_back(thing);
    } else {
      const auto thing = distractor(random, length_m, half_width_m);
      if (keeps_away(scene, thing.p_W_m, 0.5 * thing.size_m.head<2>().norm())) scene.boxes.push_back(thing);
    }
  }
}

void add_much_clutter(Random& random, const Floor& floor, Scene& scene) {
  const int clutter = random.below(kMostClutter);
  for (int i = 0; i < clutter; ++i) {
    Scene with = scene;
    add_clutter(random, floor, with);
    if (clear_of_gates(scene, with)) scene = std::move(with);
  }
}

}  // namespace

Scene random_hall(Random& random, bool cluttered) {
  Scene scene;
  scene.name = "hall";
  const double length = random.between(7.0, 16.0);
  const double half = random.between(2.5, 7.0);
  const bool outdoors = cluttered && random.chance(kOutdoors);
  const double height = outdoors ? random.between(0.1, 0.6) : random.between(2.4, 5.0);
  const double middle = 0.5 * length - 2.0;
  scene.ground.half_size_m = 15.0;
  scene.ground.texture = random_paint(random, random.between(30.0, 215.0));
  scene.boxes = {wall(random, "east wall", {length - 1.95, 0.0, 0.5 * height}, {0.1, 2.0 * half + 0.2, height}),
                 wall(random, "west wall", {-2.05, 0.0, 0.5 * height}, {0.1, 2.0 * half + 0.2, height}),
                 wall(random, "north wall", {middle, half + 0.05, 0.5 * height}, {length, 0.1, height}),
                 wall(random, "south wall", {middle, -half - 0.05, 0.5 * height}, {length, 0.1, height})};
  for (auto& side : scene.boxes) {
    if (cluttered && random.chance(0.15)) side.texture = drawn_paint(random);
  }
  if (random.chance(0.92)) scene.gates.push_back(random_gate(random, cluttered, length, half));
  if (cluttered && !scene.gates.empty() && random.chance(0.25)) {
    const auto gate = next_gate(random, scene.gates[0], length, half);
    const Vector3d& p = gate.p_W_m;
    if (p.x() > -1.5 && p.x() < length - 2.5 && std::abs(p.y()) < half - 0.6) scene.gates.push_back(gate);
  }
  add_things(random, length, half, scene);
  if (cluttered) add_much_clutter(random, {-2.0, length - 2.0, half}, scene);
  scene.lighting.ambient = random.between(0.2, 0.85);
  scene.lighting.sun = random.between(0.0, 0.7);
  scene.lighting.to_sun_W = Vector3d(random.normal(1.0), random.normal(1.0), random.between(0.3, 1.5)).normalized();
  scene.lighting.background = random.between(20.0, 240.0);
  return scene;
}

}  // namespace mebots::training
