// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "crazyflie/gains.hpp"
#include "crazyflie/pid.hpp"
#include "crazyflie/power_distribution.hpp"
#include "dynamics/airframe.hpp"
#include "math/periods.hpp"
#include "mebots/state/visitor.hpp"
#include "stabiliser/stabiliser.hpp"

#include <Eigen/Core>
#include <cstdint>

namespace mebots::world::crazyflie {

/// The cascade of PID controllers of a Crazyflie: position -> velocity -> roll, pitch and thrust at 100 Hz; attitude ->
/// rate -> four motors at 500 Hz. The cascade does not use mass or inertia.
///
/// A goal with velocities is the firmware's hover set-point: horizontal velocity relative to the heading, yaw rate,
/// altitude. If the goal is to hold the position, the controller first brakes, and then holds the position at which the
/// drone has stopped. While it brakes and holds, the altitude set-point moves to the goal's altitude at
/// Gains::climb_m_per_s or Gains::descent_m_per_s.
class Controller {
 public:
  static constexpr std::int64_t kAttitudePeriod_ns = 2'000'000;
  static constexpr std::int64_t kPositionPeriod_ns = 10'000'000;

  explicit Controller(Propellers propellers);

  /// Returns the commands (duty cycle, 0..1) for the estimated state at time_ns. They stay constant until the next
  /// attitude period. If the bus voltage is at least 2 V, applies the firmware's battery compensation.
  const RotorValues& update(const StabiliserGoal& goal, const RigidState& state, std::int64_t time_ns,
                            double bus_voltage_v);

  const RotorValues& command() const { return memory_.command; }

  void visit(state::Visitor& v);

 private:
  struct Memory {
    bool running = false;
    bool holding = false;
    Eigen::Vector3d hold_W_m = Eigen::Vector3d::Zero();
    double altitude_m = 0.0;                                 ///< set-point
    Eigen::Vector3d attitude_deg = Eigen::Vector3d::Zero();  ///< set-point of roll, pitch and yaw
    double thrust = 0.0;                                     ///< set-point, in 1/65535 of the full thrust
    std::int64_t attitude_tick = kNoPeriod;
    std::int64_t position_tick = kNoPeriod;
    RotorValues command{};
  };

  void start(const StabiliserGoal& goal, const RigidState& state, const Eigen::Vector3d& attitude_deg);
  void want_altitude(const StabiliserGoal& goal);
  void control_position(const StabiliserGoal& goal, const RigidState& state, double yaw_rad);
  RotorValues control_attitude(const RigidState& state, const Eigen::Vector3d& attitude_deg);

  const ThrustOverVoltage* rotor_;
  Gains gains_;
  Pid roll_rate_{gains_.roll_rate};
  Pid pitch_rate_{gains_.pitch_rate};
  Pid yaw_rate_{gains_.yaw_rate};
  Pid roll_{gains_.roll};
  Pid pitch_{gains_.pitch};
  Pid yaw_{gains_.yaw};
  Pid velocity_x_{gains_.velocity_xy};
  Pid velocity_y_{gains_.velocity_xy};
  Pid velocity_z_{gains_.velocity_z};
  Pid position_x_{gains_.position_xy};
  Pid position_y_{gains_.position_xy};
  Pid position_z_{gains_.position_z};
  Memory memory_;
};

}  // namespace mebots::world::crazyflie
