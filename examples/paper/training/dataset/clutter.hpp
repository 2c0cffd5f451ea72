// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "random.hpp"
#include "scene/scene.hpp"

namespace mebots::training {

/// The floor of a hall: x from `west_m` to `east_m`, y from -half_width_m to half_width_m.
struct Floor {
  double west_m = -2.0;
  double east_m = 10.0;
  double half_width_m = 4.0;
};

/// Adds an object that resembles a gate or is often near gates: a framed picture on a wall or a stand, a crate with
/// framed sides, a table, a doorway, a shelf, a tree, or a pillar with a bumper.
void add_clutter(Random& random, const Floor& floor, world::scene::Scene& scene);

/// Returns a texture of filled and hollow rectangles, as on a poster, a crate or a sheet.
world::scene::Texture drawn_paint(Random& random);

}  // namespace mebots::training
