// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "random.hpp"
#include "scene/scene.hpp"

namespace mebots::training {

/// A room as random_room() makes them, with more in it and more of a difference between one and the next. Gates of 0.42
/// to 0.9 m at other heights and of any grey level, pillars and columns, light from dim to glaring. A cluttered one has
/// gates of all shapes, sometimes a second one behind the first, and add_clutter()'s things, near to them as well.
world::scene::Scene random_hall(Random& random, bool cluttered);

}  // namespace mebots::training
