// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/ripmap.hpp"
#include "scene/scene.hpp"

#include <memory>

namespace mebots::world::camera {

/// A texture of the scene as a tile, and the lengths of the tile's edges along the surface's two axes.
struct Tile {
  Ripmap ripmap;
  double edge_u_m;
  double edge_v_m;
};

/// Draws the tile of a scene's texture. The surface's first axis is u, its second axis is v.
Tile make_tile(const scene::Texture& texture);

/// Returns a tile that all worlds of the process share while it is in use.
std::shared_ptr<const Tile> shared_tile(const scene::Texture& texture);

}  // namespace mebots::world::camera
