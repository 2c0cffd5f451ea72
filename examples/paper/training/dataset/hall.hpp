// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "random.hpp"
#include "scene/scene.hpp"

namespace mebots::training {

/// Returns a room like those of random_room(), with more objects and more variation: gates of 0.42 to 0.9 m at other
/// heights and of any grey level, pillars and columns, light from dim to glaring. A cluttered hall has gates of all
/// shapes, sometimes a second gate behind the first, and the objects of add_clutter(), also near the gates.
world::scene::Scene random_hall(Random& random, bool cluttered);

}  // namespace mebots::training
