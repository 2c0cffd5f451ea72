// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dynamics/airframe.hpp"
#include "mebots/state/visitor.hpp"
#include "scene/scene.hpp"

#include <Eigen/Core>

#include <utility>
#include <vector>

namespace mebots::world {

struct StabiliserGoal {
  bool motors_on = false;
  bool hold_place = false;       ///< brake, then hold the position; velocity and yaw rate are not used
  double forward_m_per_s = 0.0;  ///< velocity in the heading frame
  double left_m_per_s = 0.0;
  double yaw_rate_rad_per_s = 0.0;
  bool descend = false;     ///< sink at the descent speed; altitude is not used
  double altitude_m = 0.0;  ///< altitude of the body's centre above z = 0
};

/// The gains of the stabiliser. fmu_world/docs/stabiliser.md derives them.
struct Gains {
  /// The feedback gains of one rotation axis. The torque of the axis follows its command with a first-order lag.
  struct Rotation {
    double angle_per_s;   ///< rad/s of required rate per rad of error
    double rate_per_s;    ///< rad/s2 of required acceleration per rad/s of error
    double acceleration;  ///< rad/s2 subtracted per rad/s2 of measured acceleration
  };
  /// Returns gains that place the three poles of (angle, rate, acceleration) at -pole_per_s, for a torque lag of lag_s.
  /// If the lag is less than 1 / (3 pole), the gain of the acceleration is 0.
  static Rotation rotation(double pole_per_s, double lag_s);

  double tilt_pole_per_s = 12.0;
  double yaw_pole_per_s = 6.0;
  Rotation tilt;
  Rotation yaw;
  double velocity_p_per_s = 1.5;
  double velocity_i_per_s2 = 0.6;
  double position_per_s = 0.6;
  double climb_p_per_s = 3.0;
  double climb_i_per_s2 = 2.0;
  double altitude_per_s = 1.2;

  double max_tilt_rad = 0.45;           ///< about 26 degrees
  double max_rate_rad_per_s = 6.0;      ///< limit of roll and pitch rate in the angle loop
  double max_yaw_lead_rad = 0.5;        ///< limit of the heading reference minus the heading
  double max_hold_speed_m_per_s = 0.3;  ///< limit while the drone returns to the held position
  double max_climb_m_per_s = 0.5;
  double max_descent_m_per_s = 0.3;
  double max_horizontal_integral_m_per_s2 = 3.0;
  double max_vertical_integral_m_per_s2 = 4.0;
  double min_thrust_share = 0.2;         ///< of the weight, so that roll and pitch keep their effect
  double acceleration_filter_s = 0.005;  ///< lag of the filter for the measured angular acceleration

  static Gains for_lag(double rotor_lag_s);
};

/// Returns rotor thrusts that give a collective thrust and a torque about the body's axes. This function is the inverse
/// of rotor_wrench() with torque = torque_per_thrust * thrust. If the thrust of a rotor would be outside
/// 0..max_thrust_n, reduces the yaw torque first, then the collective thrust, then roll and pitch. Roll and pitch come
/// last, because they keep the drone in the air.
RotorValues mix(const scene::Drone& drone, double max_thrust_n, double collective_n,
                const Eigen::Vector3d& torque_B_n_m);

/// Converts between command and thrust of one rotor. The curve is linear between the rows of a table that was measured
/// on a bench. The true thrust also depends on the bus voltage, which the stabiliser does not measure. The altitude
/// integrator compensates the difference.
class ThrustCurve {
 public:
  /// The points must rise in both columns and start at (0, 0). load_scene() checks this.
  explicit ThrustCurve(std::vector<scene::ThrustPoint> points) : points_(std::move(points)) {}

  double max_thrust_n() const { return points_.back().thrust_n; }
  /// `thrust_n` must be from 0 to max_thrust_n().
  double command_for(double thrust_n) const;
  /// `command` must be from 0 to the command of the last point.
  double thrust_for(double command) const;

 private:
  std::vector<scene::ThrustPoint> points_;
};

/// Controls the flight with two cascades: position -> velocity -> acceleration -> tilt and thrust, and tilt -> rate ->
/// angular acceleration -> rotor thrusts -> commands. Uses mass and inertia, but neither the bus voltage nor the wind.
/// fmu_world/docs/stabiliser.md contains the equations.
class Stabiliser {
 public:
  explicit Stabiliser(const scene::Drone& drone);

  void set_mass(double mass_kg, const Eigen::Vector3d& inertia_kg_m2);

  /// Advances by dt and returns the commands (duty cycle, 0..1). If the motors are off, all commands are 0.
  const RotorValues& update(const StabiliserGoal& goal, const RigidState& state, double dt_s);

  const RotorValues& command() const { return memory_.command; }
  const Gains& gains() const { return gains_; }

  void visit(state::Visitor& v);

 private:
  struct Memory {
    bool running = false;
    bool starting = false;       ///< true while the drone is on the ground and the motors have just been switched on
    double since_start_s = 0.0;  ///< time since the motors were switched on, while starting
    bool holding = false;
    Eigen::Vector3d hold_W_m = Eigen::Vector3d::Zero();
    double heading_rad = 0.0;                                      ///< reference of the heading
    double yaw_rate_rad_per_s = 0.0;                               ///< rate of the heading reference
    Eigen::Vector3d velocity_H_m_per_s = Eigen::Vector3d::Zero();  ///< reference of the velocity, in the heading frame
    Eigen::Vector3d integral_W_m_per_s2 = Eigen::Vector3d::Zero();
    Eigen::Vector3d last_rate_B_rad_per_s = Eigen::Vector3d::Zero();
    Eigen::Vector3d acceleration_B_rad_per_s2 = Eigen::Vector3d::Zero();  ///< filtered angular acceleration
    RotorValues command{};
  };

  void start(const RigidState& state, double yaw_rad);
  double greatest_thrust_n(double dt_s);
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
