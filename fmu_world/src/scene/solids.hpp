// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/scene.hpp"

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace mebots::world::scene {

/// What there is to touch and to measure the distance to, besides the ground: one list of all shapes.
struct Solid {
  enum class Shape { box, cylinder, mesh };
  static constexpr std::size_t kNoGate = SIZE_MAX;

  Shape shape = Shape::box;
  std::string name;
  std::size_t gate = kNoGate;  ///< that it belongs to
  Eigen::Vector3d p_W_m = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q_W = Eigen::Quaterniond::Identity();  ///< its own axes into world axes
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();  ///< of a box: edges; of a cylinder: diameter, diameter, height
  std::shared_ptr<const Mesh> mesh;                  ///< of a mesh
  double radius_m = 0.0;                             ///< of a sphere round p_W_m that holds it
  Path path;
};

/// Boxes, cylinders, meshes, then the parts of gates, each kind in the scene's order.
std::vector<Solid> solids_of(const Scene& scene);

}  // namespace mebots::world::scene
