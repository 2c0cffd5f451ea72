// SPDX-License-Identifier: Apache-2.0
#include "clutter.hpp"

#include "paint.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace mebots::training {
namespace {

using Eigen::AngleAxisd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using world::scene::Box;
using world::scene::Cylinder;
using world::scene::Mesh;
using world::scene::MeshThing;
using world::scene::Picture;
using world::scene::Scene;
using world::scene::Texture;

/// A place on the floor with a heading. The parts of an object are positioned relative to it.
struct Stand {
  Vector3d p_W_m;
  double yaw_rad = 0.0;
};

Stand somewhere(Random& random, const Floor& floor) {
  return {{random.between(floor.west_m + 0.5, floor.east_m - 0.5),
           random.between(0.4 - floor.half_width_m, floor.half_width_m - 0.4), 0.0},
          random.between(-M_PI, M_PI)};
}

Texture plain(double level) {
  Texture texture;
  texture.light = texture.dark = level;
  return texture;
}

Box part(const Stand& stand, const Vector3d& middle, const Vector3d& size, const Texture& texture) {
  Box box;
  box.name = "part";
  box.p_W_m = stand.p_W_m + AngleAxisd(stand.yaw_rad, Vector3d::UnitZ()) * middle;
  box.size_m = size;
  box.yaw_rad = stand.yaw_rad;
  box.texture = texture;
  return box;
}

/// Adds a vertical board with a frame. `middle` is its centre in the stand's coordinates. Its width is along y, its
/// height along z. The painted inside protrudes 5 mm from the frame on both sides, so that it is visible.
void add_framed(Random& random, const Stand& stand, const Vector3d& middle, double width_m, double height_m,
                Scene& scene) {
  const double level = random.chance(0.5) ? random.between(200.0, 255.0) : random.between(0.0, 255.0);
  // Limits the border, so that the inside is at least two fifths of the shorter edge.
  const double border = std::min(random.between(0.03, 0.17), 0.3 * std::min(width_m, height_m));
  scene.boxes.push_back(part(stand, middle, {0.02, width_m, height_m}, plain(level)));
  const auto inside = random.chance(0.5) ? random_paint(random, random.between(20.0, 235.0)) : drawn_paint(random);
  scene.boxes.push_back(part(stand, middle, {0.03, width_m - 2.0 * border, height_m - 2.0 * border}, inside));
}

/// Adds a framed board: on a wall, or on a stand in the room.
void framed_picture(Random& random, const Floor& floor, Scene& scene) {
  Stand stand = somewhere(random, floor);
  if (random.chance(0.6)) {
    const int side = random.below(4);
    const double in_m = 0.02;
    if (side == 0) stand = {{floor.east_m - in_m, stand.p_W_m.y(), 0.0}, 0.0};
    if (side == 1) stand = {{floor.west_m + in_m, stand.p_W_m.y(), 0.0}, 0.0};
    if (side == 2) stand = {{stand.p_W_m.x(), floor.half_width_m - in_m, 0.0}, 0.5 * M_PI};
    if (side == 3) stand = {{stand.p_W_m.x(), in_m - floor.half_width_m, 0.0}, 0.5 * M_PI};
  }
  const double width = random.log_between(0.4, 1.3);
  const double height = width * random.log_between(0.7, 1.5);
  add_framed(random, stand, {0.0, 0.0, std::max(0.5 * height, random.between(0.6, 1.7))}, width, height, scene);
}

void crate(Random& random, const Stand& stand, double edge_m, double bottom_m, Scene& scene) {
  const Vector3d middle{0.0, 0.0, bottom_m + 0.5 * edge_m};
  const double level = random.between(40.0, 240.0);
  if (random.chance(0.5)) {
    auto texture = drawn_paint(random);
    texture.scale_m = edge_m;
    scene.boxes.push_back(part(stand, middle, Vector3d::Constant(edge_m), texture));
    return;
  }
  scene.boxes.push_back(part(stand, middle, Vector3d::Constant(edge_m), plain(level)));
  const double beam = edge_m * random.between(0.08, 0.2);
  const auto frame = plain(std::clamp(level + random.between(-90.0, 90.0), 0.0, 255.0));
  const double deep = edge_m + 0.03;
  for (const double side : {-0.5, 0.5}) {
    const double away = side * (edge_m - beam);
    scene.boxes.push_back(part(stand, middle + Vector3d(0.0, away, 0.0), {deep, beam, edge_m}, frame));
    scene.boxes.push_back(part(stand, middle + Vector3d(0.0, 0.0, away), {deep, edge_m, beam}, frame));
  }
}

/// Adds a table (four legs with a board) or a doorway (two posts with a bar).
void table_or_doorway(Random& random, const Floor& floor, Scene& scene) {
  const Stand stand = somewhere(random, floor);
  const auto paint = random_paint(random, random.between(20.0, 235.0));
  const bool table = random.chance(0.5);
  const double width = table ? random.between(0.5, 1.4) : random.between(0.6, 1.2);
  const double height = table ? random.between(0.4, 1.0) : random.between(1.2, 2.2);
  const double depth = table ? random.between(0.4, 0.8) : 0.0;
  const double beam = random.between(0.04, 0.12);
  for (const double y : {-0.5 * width, 0.5 * width}) {
    scene.boxes.push_back(part(stand, {-0.5 * depth, y, 0.5 * height}, {beam, beam, height}, paint));
    if (table) scene.boxes.push_back(part(stand, {0.5 * depth, y, 0.5 * height}, {beam, beam, height}, paint));
  }
  scene.boxes.push_back(part(stand, {0.0, 0.0, height}, {depth + beam, width + beam, beam}, paint));
}

void shelf(Random& random, const Floor& floor, Scene& scene) {
  const Stand stand = somewhere(random, floor);
  const auto paint = random_paint(random, random.between(20.0, 235.0));
  const double width = random.between(0.8, 2.2);
  const double depth = random.between(0.3, 0.8);
  const double height = random.between(1.2, 2.6);
  const double beam = random.between(0.03, 0.08);
  for (const double x : {-0.5 * depth, 0.5 * depth}) {
    for (const double y : {-0.5 * width, 0.5 * width}) {
      scene.boxes.push_back(part(stand, {x, y, 0.5 * height}, {beam, beam, height}, paint));
    }
  }
  const int levels = 2 + random.below(3);
  for (int level = 0; level < levels; ++level) {
    const double bottom = 0.1 + level * (height - 0.2) / levels;
    scene.boxes.push_back(part(stand, {0.0, 0.0, bottom}, {depth, width, 0.04}, paint));
    for (double y = -0.5 * width + 0.3; y < 0.5 * width - 0.2; y += 0.6) {
      if (random.chance(0.4)) continue;
      const Vector3d shift{0.0, y, 0.0};
      const Stand place{stand.p_W_m + AngleAxisd(stand.yaw_rad, Vector3d::UnitZ()) * shift, stand.yaw_rad};
      crate(random, place, random.between(0.2, std::min(0.5, (height - 0.2) / levels)), bottom + 0.02, scene);
    }
  }
}

/// Creates a surface of revolution. `profile_m` contains radius and height of at least two points, from top to bottom.
Mesh lathed(const std::vector<Vector2d>& profile_m, int sides, double wobble, const Texture& texture, Random& random) {
  Mesh mesh;
  mesh.materials = {texture};
  for (const auto& at : profile_m) {
    for (int i = 0; i < sides; ++i) {
      const double angle = 2.0 * M_PI * i / sides;
      const double radius = at.x() * (1.0 + random.between(-wobble, wobble));
      mesh.points_m.emplace_back(radius * std::cos(angle), radius * std::sin(angle), at.y());
    }
  }
  const auto count = static_cast<std::uint32_t>(sides);
  for (std::uint32_t ring = 0; ring + 1 < profile_m.size(); ++ring) {
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t upper = ring * count + i;
      const std::uint32_t upper_next = ring * count + (i + 1) % count;
      mesh.triangles.push_back({{upper, upper + count, upper_next + count}, 0, {}});
      mesh.triangles.push_back({{upper, upper_next + count, upper_next}, 0, {}});
    }
  }
  return mesh;
}

/// Adds a trunk with a conical or round crown.
void tree(Random& random, const Floor& floor, Scene& scene) {
  const Stand stand = somewhere(random, floor);
  const double height = random.between(1.5, 5.0);
  const double bare = height * random.between(0.1, 0.45);
  const double reach = height * random.between(0.15, 0.3);
  Cylinder trunk;
  trunk.name = "trunk";
  trunk.radius_m = height * random.between(0.02, 0.06);
  trunk.height_m = bare + 0.2 * (height - bare);
  trunk.p_W_m = stand.p_W_m + Vector3d(0.0, 0.0, 0.5 * trunk.height_m);
  trunk.texture = random_paint(random, random.between(30.0, 180.0));
  scene.cylinders.push_back(trunk);

  std::vector<Vector2d> profile;
  constexpr double kTip = 0.01;
  if (random.chance(0.5)) {
    const int skirts = 2 + random.below(3);
    for (int i = 0; i < skirts; ++i) {
      const double top = height - i * (height - bare) / skirts;
      const double bottom = height - (i + 1.0) * (height - bare) / skirts;
      profile.emplace_back(i == 0 ? kTip : 0.4 * reach * i / skirts, top);
      profile.emplace_back(reach * (i + 1.0) / skirts, bottom);
    }
  } else {
    constexpr int kRings = 7;
    for (int i = 0; i < kRings; ++i) {
      const double angle = M_PI * i / (kRings - 1);
      profile.emplace_back(std::max(kTip, reach * std::sin(angle)),
                           bare + 0.5 * (height - bare) * (1.0 + std::cos(angle)));
    }
  }
  MeshThing crown;
  crown.name = "crown";
  crown.p_W_m = stand.p_W_m;
  crown.yaw_rad = stand.yaw_rad;
  crown.mesh = std::make_shared<const Mesh>(lathed(profile, 6 + random.below(5), random.between(0.0, 0.3),
                                                   random_paint(random, random.between(20.0, 170.0)), random));
  scene.meshes.push_back(crown);
}

void pillar(Random& random, const Floor& floor, Scene& scene) {
  const Stand stand = somewhere(random, floor);
  const double radius = random.between(0.06, 0.3);
  const auto add = [&](double wide, double height, const Texture& texture) {
    Cylinder cylinder;
    cylinder.name = "pillar";
    cylinder.radius_m = wide;
    cylinder.height_m = height;
    cylinder.p_W_m = stand.p_W_m + Vector3d(0.0, 0.0, 0.5 * height);
    cylinder.texture = texture;
    scene.cylinders.push_back(cylinder);
  };
  add(radius, random.between(1.5, 4.0),
      plain(random.chance(0.5) ? random.between(200.0, 255.0) : random.between(0.0, 255.0)));
  if (random.chance(0.5))
    add(radius + 0.04, random.between(0.3, 1.2), random_paint(random, random.between(50.0, 200.0)));
}

}  // namespace

Texture drawn_paint(Random& random) {
  constexpr int kEdge = 64;
  auto picture = std::make_shared<Picture>();
  picture->width = picture->height = kEdge;
  picture->grey.assign(static_cast<std::size_t>(kEdge) * kEdge, static_cast<std::uint8_t>(random.below(256)));
  const int rectangles = 1 + random.below(7);
  for (int i = 0; i < rectangles; ++i) {
    const int left = random.below(kEdge - 8);
    const int top = random.below(kEdge - 8);
    const int right = left + 6 + random.below(kEdge - 6 - left);
    const int bottom = top + 6 + random.below(kEdge - 6 - top);
    const int border = random.chance(0.5) ? 1 + random.below(8) : kEdge;
    const auto level = static_cast<std::uint8_t>(random.below(256));
    for (int y = top; y < std::min(bottom, kEdge); ++y) {
      for (int x = left; x < std::min(right, kEdge); ++x) {
        const int deep = std::min(std::min(x - left, right - 1 - x), std::min(y - top, bottom - 1 - y));
        if (deep < border) picture->grey[static_cast<std::size_t>(y) * kEdge + x] = level;
      }
    }
  }
  Texture texture;
  texture.kind = Texture::Kind::picture;
  texture.dark = 0.0;
  texture.light = 255.0;
  texture.scale_m = random.log_between(0.3, 2.0);
  texture.picture = std::move(picture);
  return texture;
}

void add_clutter(Random& random, const Floor& floor, Scene& scene) {
  const double kind = random.unit();
  if (kind < 0.3) return framed_picture(random, floor, scene);
  if (kind < 0.45) {
    const Stand stand = somewhere(random, floor);
    return crate(random, stand, random.between(0.3, 0.9), random.chance(0.6) ? 0.0 : random.between(0.2, 1.2), scene);
  }
  if (kind < 0.6) return table_or_doorway(random, floor, scene);
  if (kind < 0.7) return shelf(random, floor, scene);
  if (kind < 0.85) return tree(random, floor, scene);
  pillar(random, floor, scene);
}

}  // namespace mebots::training
