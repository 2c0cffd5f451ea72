// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "random.hpp"
#include "scene/scene.hpp"

namespace mebots::training {

/// Returns a random paint with grey levels around `middle`.
world::scene::Texture random_paint(Random& random, double middle);

/// Returns an upright wall in random paint, with grey levels around a random value from 50 to 210.
world::scene::Box wall(Random& random, const char* name, const Eigen::Vector3d& centre, const Eigen::Vector3d& size);

/// Returns a pillar, a crate or a board of about the size of a gate.
world::scene::Box distractor(Random& random, double length_m, double half_width_m);

}  // namespace mebots::training
