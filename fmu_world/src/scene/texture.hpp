// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/png_file.hpp"

#include <cstdint>
#include <memory>

namespace mebots::world::scene {

using Picture = GreyPicture;

/// How a surface reflects. Grey levels are 0 (black) to 255 (white) as the camera sees the surface
/// under a light of 1.
struct Texture {
  enum class Kind {
    uniform,  ///< `light` everywhere
    checker,  ///< squares of edge `scale_m`, alternating
    stripes,  ///< bands of width `scale_m` across the surface's first axis, alternating
    noise,    ///< smooth value noise between `dark` and `light`, lattice of `scale_m`
    bricks,   ///< `light` bricks 2 scale_m x scale_m, every second row shifted by half, joints `dark`
    picture,  ///< `picture`, its black `dark` and its white `light`, `scale_m` wide and upright, again and again
  };
  Kind kind = Kind::uniform;
  double light = 200.0;    ///< grey level, 0..255
  double dark = 100.0;     ///< grey level, 0..255
  double scale_m = 0.5;    ///< size of the pattern's element, > 0
  std::uint32_t seed = 0;  ///< of `noise`, and of the small differences between bricks
  std::shared_ptr<const Picture> picture = nullptr;

  bool operator==(const Texture& other) const {
    const bool same_picture = picture == other.picture || (picture && other.picture && *picture == *other.picture);
    return kind == other.kind && light == other.light && dark == other.dark && scale_m == other.scale_m &&
           seed == other.seed && same_picture;
  }
};

}  // namespace mebots::world::scene
