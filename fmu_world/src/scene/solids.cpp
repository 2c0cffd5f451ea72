// SPDX-License-Identifier: Apache-2.0
#include "scene/solids.hpp"

#include <cmath>

namespace mebots::world::scene {
namespace {

template <typename Thing>
Solid placed(const Thing& thing, Solid::Shape shape) {
  Solid solid;
  solid.shape = shape;
  solid.name = thing.name;
  solid.p_W_m = thing.p_W_m;
  solid.q_W = attitude_of(thing);
  return solid;
}

Solid solid_of(const Box& box) {
  Solid solid = placed(box, Solid::Shape::box);
  solid.size_m = box.size_m;
  solid.radius_m = 0.5 * box.size_m.norm();
  solid.path = box.path;
  return solid;
}

Solid solid_of(const Cylinder& cylinder) {
  Solid solid = placed(cylinder, Solid::Shape::cylinder);
  solid.size_m = {2.0 * cylinder.radius_m, 2.0 * cylinder.radius_m, cylinder.height_m};
  solid.radius_m = std::sqrt(cylinder.radius_m * cylinder.radius_m + 0.25 * cylinder.height_m * cylinder.height_m);
  solid.path = cylinder.path;
  return solid;
}

Solid solid_of(const MeshThing& thing) {
  Solid solid = placed(thing, Solid::Shape::mesh);
  solid.mesh = thing.mesh;
  solid.radius_m = thing.mesh->radius_m();
  solid.path = thing.path;
  return solid;
}

}  // namespace

std::vector<Solid> solids_of(const Scene& scene) {
  std::vector<Solid> solids;
  for (const Box& box : scene.boxes) solids.push_back(solid_of(box));
  for (const Cylinder& cylinder : scene.cylinders) solids.push_back(solid_of(cylinder));
  for (const MeshThing& thing : scene.meshes) solids.push_back(solid_of(thing));
  for (std::size_t i = 0; i < scene.gates.size(); ++i) {
    const Gate& gate = scene.gates[i];
    const std::size_t first = solids.size();
    if (gate.has_beams()) {
      for (const Box& beam : gate.beams()) solids.push_back(solid_of(beam));
    } else {
      solids.push_back(placed(gate, Solid::Shape::mesh));
      solids.back().mesh = std::make_shared<const Mesh>(gate.frame());
      solids.back().radius_m = solids.back().mesh->radius_m();
    }
    for (std::size_t part = first; part < solids.size(); ++part) solids[part].gate = i;
  }
  return solids;
}

}  // namespace mebots::world::scene
