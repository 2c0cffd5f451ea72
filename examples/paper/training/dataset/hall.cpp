// SPDX-License-Identifier: Apache-2.0
#include "hall.hpp"

#include "paint.hpp"

#include <algorithm>
#include <cmath>

namespace mebots::training {
namespace {

using Eigen::Vector3d;
using world::scene::Cylinder;
using world::scene::Gate;
using world::scene::Scene;
using world::scene::Texture;

constexpr int kMostThings = 11;
constexpr double kClearOfGate_m = 0.8;

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

Gate random_gate(Random& random, double length_m, double half_width_m) {
  Gate gate;
  gate.name = "gate";
  gate.outer_m = random.chance(0.5) ? random.between(0.54, 0.66) : random.log_between(0.42, 0.9);
  gate.inner_m = gate.outer_m * random.between(0.6, 0.75);
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

/// Whether a thing of that half diagonal keeps away from the gate, so that it does not hide it from every side.
bool keeps_away(const Scene& scene, const Vector3d& p_W, double reach_m) {
  if (scene.gates.empty()) return true;
  return (p_W - scene.gates[0].p_W_m).head<2>().norm() >= kClearOfGate_m + reach_m;
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

}  // namespace

Scene random_hall(Random& random) {
  Scene scene;
  scene.name = "hall";
  const double length = random.between(7.0, 16.0);
  const double half = random.between(2.5, 7.0);
  const double height = random.between(2.4, 5.0);
  const double middle = 0.5 * length - 2.0;
  scene.ground.half_size_m = 15.0;
  scene.ground.texture = random_paint(random, random.between(30.0, 215.0));
  scene.boxes = {wall(random, "east wall", {length - 1.95, 0.0, 0.5 * height}, {0.1, 2.0 * half + 0.2, height}),
                 wall(random, "west wall", {-2.05, 0.0, 0.5 * height}, {0.1, 2.0 * half + 0.2, height}),
                 wall(random, "north wall", {middle, half + 0.05, 0.5 * height}, {length, 0.1, height}),
                 wall(random, "south wall", {middle, -half - 0.05, 0.5 * height}, {length, 0.1, height})};
  if (random.chance(0.92)) scene.gates.push_back(random_gate(random, length, half));
  add_things(random, length, half, scene);
  scene.lighting.ambient = random.between(0.2, 0.85);
  scene.lighting.sun = random.between(0.0, 0.7);
  scene.lighting.to_sun_W = Vector3d(random.normal(1.0), random.normal(1.0), random.between(0.3, 1.5)).normalized();
  scene.lighting.background = random.between(20.0, 240.0);
  return scene;
}

}  // namespace mebots::training
