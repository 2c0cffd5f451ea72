// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "random.hpp"
#include "scene/scene.hpp"

namespace mebots::training {

/// Returns a room like random_room(), with more objects and more variation: gates of 0.42 to 0.9 m, other heights, any
/// grey level, pillars and columns, light from dim to glaring. A cluttered hall also has gates of all shapes, sometimes
/// a second gate farther away, and objects of add_clutter(), some of them near the gates.
world::scene::Scene random_hall(Random& random, bool cluttered);

}  // namespace mebots::training
