// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dynamics/airframe.hpp"
#include "scene/scene.hpp"

#include <cstddef>
#include <span>

namespace mebots::world {

/// The drones and robots that a drone's sensors may see: first all drones, then all robots. Sensors ignore their own
/// drone. In a world of one drone without robots, the lists are empty.
struct Others {
  std::span<const scene::Solid> boxes;  ///< contact boxes of drones and parts of robots where they are now
  std::span<const RigidState> states;
  std::size_t own = 0;
};

}  // namespace mebots::world
