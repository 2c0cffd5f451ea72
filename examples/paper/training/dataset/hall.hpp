// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "random.hpp"
#include "scene/scene.hpp"

namespace mebots::training {

/// Returns a room like those of random_room(), with more objects and more variation. Its gates have 0.42 to 0.9 m,
/// other heights and any grey level. It has pillars and columns, and light from dim to glaring. A cluttered hall has
/// gates of all shapes, sometimes a second gate farther away, and the objects of add_clutter(), some of them near the
/// gates.
world::scene::Scene random_hall(Random& random, bool cluttered);

}  // namespace mebots::training
