// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dynamics/airframe.hpp"
#include "scene/scene.hpp"

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace mebots::world {

/// Standard acceleration of free fall (3rd CGPM, 1901).
inline constexpr double kGravity_m_per_s2 = 9.80665;

/// A contact point of the drone with another object, found before a step.
struct Touch {
  enum class What { ground, obstacle, gate };
  What what = What::ground;
  std::size_t index = 0;  ///< of the obstacle in scene::solids_of(), or of the gate in the scene
  Eigen::Vector3d p_W_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal_W = Eigen::Vector3d::UnitZ();  ///< towards the drone
  double depth_m = 0.0;                                 ///< how far the bodies overlap
  double closing_speed_m_per_s = 0.0;  ///< velocity towards each other along the normal, positive = approaching
};

/// The drone as one rigid box among ground, obstacles and gates, moved by ODE's dWorldStep.
///
/// Obstacles on a path are kinematic bodies of ODE: at the start of each step they get the path's position and
/// velocity, and no force changes them.
///
/// The caller owns the body's state. Every step copies it into ODE and back, so ODE has no memory between steps, and a
/// restored state continues with the same bits. Geometries are in the scene's order, not in an ODE space, whose order
/// depends on history. dWorldStep integrates semi-implicitly: v' = v + a dt, p' = p + v' dt, first order in dt;
/// rotations are finite, gyroscopic torque is implicit.
class RigidWorld {
 public:
  explicit RigidWorld(const scene::Scene& scene);
  ~RigidWorld();
  RigidWorld(const RigidWorld&) = delete;
  RigidWorld& operator=(const RigidWorld&) = delete;

  /// Sets mass and principal moments about body axes. All must be positive.
  void set_mass(double mass_kg, const Eigen::Vector3d& inertia_kg_m2);

  /// Advances `state` by dt from `time_ns` under gravity, contact and the given wrench (force in world axes, torque in
  /// body axes). Returns the touches at the state before the step; valid until the next call. Throws mebots::Error if
  /// the state is or becomes not finite, or if any value is 1e40 or more.
  const std::vector<Touch>& step(RigidState& state, const Eigen::Vector3d& force_W_n,
                                 const Eigen::Vector3d& torque_B_n_m, double dt_s, std::int64_t time_ns = 0);

  /// Returns the touches at a state and time, without a step; valid until the next call.
  const std::vector<Touch>& touches_at(const RigidState& state, std::int64_t time_ns = 0);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mebots::world
