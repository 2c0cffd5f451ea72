// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/ripmap.hpp"
#include "scene/scene.hpp"

#include <memory>

namespace mebots::world::camera {

/// The tile of a texture, and the lengths of the tile's edges along the surface's two axes.
struct Tile {
  Ripmap ripmap;
  double edge_u_m;
  double edge_v_m;
};

/// Draws the tile of a texture. u is the surface's first axis, v its second axis.
Tile make_tile(const scene::Texture& texture);

/// Returns the tile of a texture. All worlds of the process share it while it is in use.
std::shared_ptr<const Tile> shared_tile(const scene::Texture& texture);

}  // namespace mebots::world::camera
