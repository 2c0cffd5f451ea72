// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "random.hpp"
#include "scene/scene.hpp"

namespace mebots::training {

/// Returns a room with at most one gate and some other objects: random sizes, places, paint and light. The direction of
/// flight is the gate's x axis, as everywhere in fmu_world.
world::scene::Scene random_room(Random& random);

}  // namespace mebots::training
