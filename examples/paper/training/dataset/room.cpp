// SPDX-License-Identifier: Apache-2.0
#include "room.hpp"

#include "paint.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace mebots::training {
namespace {

using Eigen::Vector3d;
using world::scene::Box;
using world::scene::Gate;
using world::scene::Scene;
using world::scene::Texture;

/// The minimum distance between the gate and other objects. Farther objects cannot hide the gate from every side.
constexpr double kFreeAroundGate_m = 0.9;

Texture gate_paint(Random& random) {
  const double kind = random.unit();
  const double level = kind < 0.6   ? random.between(215.0, 255.0)
                       : kind < 0.8 ? random.between(0.0, 45.0)
                                    : random.between(0.0, 255.0);
  Texture texture;
  texture.light = level;
  texture.dark = level;
  if (random.chance(0.2)) {
    texture.kind = random.chance(0.5) ? Texture::Kind::checker : Texture::Kind::stripes;
    texture.dark = std::clamp(level + random.between(-60.0, 60.0), 0.0, 255.0);
    texture.scale_m = random.between(0.03, 0.2);
  }
  return texture;
}

}  // namespace

Scene random_room(Random& random) {
  Scene scene;
  scene.name = "room";
  const double length = random.between(7.0, 14.0);
  const double half = random.between(2.5, 6.0);
  const double height = random.between(2.4, 4.0);
  const double middle = 0.5 * length - 2.0;
  scene.ground.half_size_m = 15.0;
  scene.ground.texture = random_paint(random, random.between(40.0, 200.0));
  scene.boxes = {wall(random, "east wall", {length - 1.95, 0.0, 0.5 * height}, {0.1, 2.0 * half + 0.2, height}),
                 wall(random, "west wall", {-2.05, 0.0, 0.5 * height}, {0.1, 2.0 * half + 0.2, height}),
                 wall(random, "north wall", {middle, half + 0.05, 0.5 * height}, {length, 0.1, height}),
                 wall(random, "south wall", {middle, -half - 0.05, 0.5 * height}, {length, 0.1, height})};

  if (random.chance(0.96)) {
    Gate gate;
    gate.name = "gate";
    gate.outer_m = 0.6 * random.between(0.88, 1.12);
    gate.inner_m = gate.outer_m * random.between(0.62, 0.71);
    gate.thickness_m = random.between(0.02, 0.06);
    gate.p_W_m = {random.between(0.0, length - 2.6), random.between(0.8 - half, half - 0.8), random.between(0.9, 1.2)};
    gate.yaw_rad = random.between(-M_PI, M_PI);
    gate.texture = gate_paint(random);
    scene.gates.push_back(gate);
  }
  const int distractors = random.below(6);
  for (int i = 0; i < distractors; ++i) {
    const Box box = distractor(random, length, half);
    if (!scene.gates.empty()) {
      const Vector3d away = box.p_W_m - scene.gates[0].p_W_m;
      if (away.head<2>().norm() < kFreeAroundGate_m + 0.5 * box.size_m.head<2>().norm()) continue;
    }
    scene.boxes.push_back(box);
  }

  scene.lighting.ambient = random.between(0.3, 0.8);
  scene.lighting.sun = random.between(0.0, 0.6);
  scene.lighting.to_sun_W = Vector3d(random.normal(1.0), random.normal(1.0), random.between(0.3, 1.5)).normalized();
  scene.lighting.background = random.between(20.0, 240.0);
  return scene;
}

}  // namespace mebots::training
