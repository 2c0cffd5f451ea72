// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dynamics/airframe.hpp"
#include "scene/scene.hpp"

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace mebots::world {

/// Standard acceleration of free fall (3rd CGPM, 1901).
inline constexpr double kGravity_m_per_s2 = 9.80665;

/// A contact point of a drone with another object at the start of a step.
struct Touch {
  enum class What { ground, obstacle, gate, drone, robot };
  What what = What::ground;
  std::size_t index = 0;  ///< of the obstacle in scene::solids_of(), of the gate in the scene, or of drone or robot
  Eigen::Vector3d p_W_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal_W = Eigen::Vector3d::UnitZ();  ///< towards the drone
  double depth_m = 0.0;                                 ///< how far the bodies overlap
  double closing_speed_m_per_s = 0.0;  ///< velocity towards each other along the normal, positive = approaching
};

/// Simulates drones as rigid boxes that can touch ground, obstacles, gates and each other. ODE's dWorldStep moves them.
///
/// In each step, call place() for every drone, then step(), then state() and touches() for every drone.
///
/// Obstacles on a path and robots are kinematic bodies of ODE: forces do not move them. At the start of each step, they
/// receive their position and velocity from the path or from move_robot().
///
/// The caller owns the bodies' states. Every step copies the states into ODE and back. ODE stores nothing between
/// steps, so a run from a restored state gives the same bits. Geometries have the scene's order. They are not in an ODE
/// space, whose order depends on earlier steps. To find pairs of drones that may touch, their positions are sorted
/// along x.
///
/// dWorldStep integrates semi-implicitly, with first order in dt: v' = v + a dt, p' = p + v' dt. It integrates
/// rotations as finite rotations, and the gyroscopic torque implicitly. Drones that do not touch each other are solved
/// separately. Each of them has the same bits as in a world without the others.
class RigidWorld {
 public:
  /// `body_sizes_m` contains the edges of each drone's box. `robots` is the number of the scene's robots.
  RigidWorld(const scene::Scene& scene, std::span<const Eigen::Vector3d> body_sizes_m, std::size_t robots = 0);
  ~RigidWorld();
  RigidWorld(const RigidWorld&) = delete;
  RigidWorld& operator=(const RigidWorld&) = delete;

  /// Sets the mass and the principal moments about body axes of a drone. All must be positive.
  void set_mass(std::size_t drone, double mass_kg, const Eigen::Vector3d& inertia_kg_m2);

  /// Sets the state of a drone, and the wrench on it during the next step: force in world axes, torque in body axes.
  /// Throws mebots::Error if a value is not finite, or if its magnitude is 1e40 or more.
  void place(std::size_t drone, const RigidState& state, const Eigen::Vector3d& force_W_n = Eigen::Vector3d::Zero(),
             const Eigen::Vector3d& torque_B_n_m = Eigen::Vector3d::Zero());

  /// Sets the state of a robot at the start of the next step. Throws mebots::Error with the robot's name if a value is
  /// not finite, or too large for ODE.
  void move_robot(std::size_t robot, const RigidState& state);

  /// Finds the touches at `time_ns`. Then advances all drones by dt under gravity, contact forces and their wrenches.
  void step(double dt_s, std::int64_t time_ns);

  /// Finds the touches of all drones at their current positions, without a step.
  void find_touches(std::int64_t time_ns);

  /// Returns a drone's state after the last step. Throws mebots::Error if it is not finite.
  RigidState state(std::size_t drone) const;
  /// Returns the touches of a drone before the last step. The result is valid until the next step.
  const std::vector<Touch>& touches(std::size_t drone) const;
  /// True if the robot touched a drone, an obstacle, a gate or another robot before the last step.
  bool robot_touches(std::size_t robot) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mebots::world
