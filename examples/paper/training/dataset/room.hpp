// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "random.hpp"
#include "scene/scene.hpp"

namespace mebots::training {

/// A room with at most one gate and some things that are none: sizes, places, paint and light at random.
/// The gate's opening faces along its own x, as everywhere in fmu_world.
world::scene::Scene random_room(Random& random);

}  // namespace mebots::training
