// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dynamics/airframe.hpp"
#include "dynamics/rigid_state.hpp"
#include "mebots/state/visitor.hpp"
#include "stabiliser/gains.hpp"
#include "stabiliser/goal.hpp"
#include "stabiliser/thrust_curve.hpp"

#include <Eigen/Core>

namespace mebots::world {

/// Cascaded flight controller: position -> velocity -> acceleration -> tilt and thrust; tilt -> rate ->
/// angular acceleration -> rotor thrusts -> commands. It uses mass and inertia, but neither the bus voltage nor the
/// wind. fmu_world/docs/stabiliser.md has the equations.
class Stabiliser {
 public:
  explicit Stabiliser(const scene::Drone& drone);

  void set_mass(double mass_kg, const Eigen::Vector3d& inertia_kg_m2);

  /// Commands (duty cycle, 0..1) after dt seconds more; all 0 with the motors off.
  const RotorValues& update(const StabiliserGoal& goal, const RigidState& state, double dt_s);

  const RotorValues& command() const { return memory_.command; }
  const Gains& gains() const { return gains_; }

  void visit(state::Visitor& v);

 private:
  /// Everything that the controller remembers.
  struct Memory {
    bool running = false;
    bool holding = false;
    Eigen::Vector3d hold_W_m = Eigen::Vector3d::Zero();
    double heading_rad = 0.0;                                      ///< reference
    double yaw_rate_rad_per_s = 0.0;                               ///< rate of that reference
    Eigen::Vector3d velocity_H_m_per_s = Eigen::Vector3d::Zero();  ///< reference, heading frame
    Eigen::Vector3d integral_W_m_per_s2 = Eigen::Vector3d::Zero();
    Eigen::Vector3d last_rate_B_rad_per_s = Eigen::Vector3d::Zero();
    Eigen::Vector3d acceleration_B_rad_per_s2 = Eigen::Vector3d::Zero();  ///< filtered
    RotorValues command{};
  };

  void start(const RigidState& state, double yaw_rad);
  Eigen::Vector3d wanted_velocity(const StabiliserGoal& goal, const RigidState& state, double yaw_rad);
  Eigen::Vector3d wanted_acceleration(const StabiliserGoal& goal, const RigidState& state, double yaw_rad, double dt_s);
  Eigen::Vector3d wanted_torque(const StabiliserGoal& goal, const RigidState& state, double yaw_rad,
                                const Eigen::Vector3d& up_W, double dt_s);

  scene::Drone drone_;
  ThrustCurve curve_;
  Gains gains_;
  double mass_kg_ = 0.0;
  Eigen::Vector3d inertia_kg_m2_ = Eigen::Vector3d::Zero();
  Memory memory_;
};

}  // namespace mebots::world
