// SPDX-License-Identifier: Apache-2.0
#include "paint.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace mebots::training {

using Eigen::Vector3d;
using world::scene::Box;
using world::scene::Texture;

Texture random_paint(Random& random, double middle) {
  constexpr std::array kKinds{Texture::Kind::uniform, Texture::Kind::checker, Texture::Kind::stripes,
                              Texture::Kind::noise, Texture::Kind::bricks};
  Texture texture;
  texture.kind = kKinds[static_cast<std::size_t>(random.below(kKinds.size()))];
  const double spread = random.between(5.0, 45.0);
  texture.light = std::clamp(middle + spread, 0.0, 255.0);
  texture.dark = std::clamp(middle - spread, 0.0, 255.0);
  texture.scale_m = random.log_between(0.1, 0.9);
  texture.seed = random.word();
  return texture;
}

Box wall(Random& random, const char* name, const Vector3d& centre, const Vector3d& size) {
  Box box;
  box.name = name;
  box.p_W_m = centre;
  box.size_m = size;
  box.texture = random_paint(random, random.between(50.0, 210.0));
  return box;
}

Box distractor(Random& random, double length_m, double half_width_m) {
  Box box;
  box.name = "distractor";
  const double kind = random.unit();
  if (kind < 0.35) {
    box.size_m = {random.between(0.1, 0.4), random.between(0.1, 0.4), random.between(1.0, 2.5)};
  } else if (kind < 0.65) {
    box.size_m = {random.between(0.3, 1.0), random.between(0.3, 1.0), random.between(0.3, 1.2)};
  } else {
    const double edge = random.between(0.35, 0.8);
    box.size_m = {0.03, edge, edge * random.between(0.8, 1.2)};
  }
  const double lift = kind < 0.65 ? 0.0 : random.between(0.2, 1.4);
  box.p_W_m = {random.between(-1.0, length_m - 2.5), random.between(-half_width_m, half_width_m),
               0.5 * box.size_m.z() + lift};
  box.yaw_rad = random.between(-M_PI, M_PI);
  box.texture = random_paint(random, random.between(20.0, 235.0));
  return box;
}

}  // namespace mebots::training
