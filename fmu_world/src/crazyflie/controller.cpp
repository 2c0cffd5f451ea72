// SPDX-License-Identifier: Apache-2.0
#include "crazyflie/controller.hpp"

#include "math/periods.hpp"
#include "math/rotation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mebots::world::crazyflie {
namespace {

constexpr double kAttitudePeriod_s = 1e-9 * static_cast<double>(Controller::kAttitudePeriod_ns);
constexpr double kPositionPeriod_s = 1e-9 * static_cast<double>(Controller::kPositionPeriod_ns);
constexpr double kDegrees = 180.0 / std::numbers::pi;
/// When the speed of a braking drone falls below this value, the drone holds its position.
constexpr double kStoppedSpeed_m_per_s = 0.05;
/// Lower supply voltages are ignored, as in the firmware.
constexpr double kLeastSupply_v = 2.0;

}  // namespace

Controller::Controller(Propellers propellers) : rotor_(&thrust_over_voltage(propellers)) {}

void Controller::start(const StabiliserGoal& goal, const RigidState& state, const Eigen::Vector3d& attitude_deg) {
  memory_ = {};
  memory_.running = true;
  memory_.attitude_deg.z() = attitude_deg.z();
  memory_.altitude_m = goal.hold_place ? state.p_WB_m.z() : goal.altitude_m;
  for (Pid* pid : {&roll_rate_, &pitch_rate_, &yaw_rate_, &velocity_x_, &velocity_y_, &velocity_z_}) pid->reset(0.0);
  roll_.reset(attitude_deg.x());
  pitch_.reset(attitude_deg.y());
  yaw_.reset(attitude_deg.z());
  position_x_.reset(0.0);
  position_y_.reset(0.0);
  position_z_.reset(state.p_WB_m.z());
}

void Controller::want_altitude(const StabiliserGoal& goal) {
  if (!goal.hold_place) {
    memory_.altitude_m = goal.altitude_m;
    return;
  }
  const double down_m = gains_.descent_m_per_s * kPositionPeriod_s;
  const double up_m = gains_.climb_m_per_s * kPositionPeriod_s;
  memory_.altitude_m += goal.descend ? -down_m : std::clamp(goal.altitude_m - memory_.altitude_m, -down_m, up_m);
}

void Controller::control_position(const StabiliserGoal& goal, const RigidState& state, double yaw_rad) {
  const Eigen::Quaterniond to_heading = yaw_rotation(-yaw_rad);
  const Eigen::Vector3d velocity_H = to_heading * state.v_WB_m_per_s;
  if (!goal.hold_place) {
    memory_.holding = false;
  } else if (!memory_.holding && velocity_H.head<2>().norm() < kStoppedSpeed_m_per_s) {
    memory_.holding = true;
    memory_.hold_W_m = state.p_WB_m;
  }
  want_altitude(goal);

  Eigen::Vector3d wanted_H = Eigen::Vector3d::Zero();
  if (memory_.holding) {
    const Eigen::Vector3d back_H = to_heading * (memory_.hold_W_m - state.p_WB_m);
    wanted_H.x() = position_x_.update(back_H.x(), 0.0, kPositionPeriod_s);
    wanted_H.y() = position_y_.update(back_H.y(), 0.0, kPositionPeriod_s);
  } else if (!goal.hold_place) {
    wanted_H.x() = goal.forward_m_per_s;
    wanted_H.y() = goal.left_m_per_s;
  }
  wanted_H.z() = position_z_.update(memory_.altitude_m, state.p_WB_m.z(), kPositionPeriod_s);

  // To fly forward, the drone must lower its nose. To fly to the right, it must lower its right side.
  const double forward = velocity_x_.update(wanted_H.x(), velocity_H.x(), kPositionPeriod_s);
  const double left = velocity_y_.update(wanted_H.y(), velocity_H.y(), kPositionPeriod_s);
  memory_.attitude_deg.x() = std::clamp(-left, -gains_.max_tilt_deg, gains_.max_tilt_deg);
  memory_.attitude_deg.y() = std::clamp(forward, -gains_.max_tilt_deg, gains_.max_tilt_deg);
  const double up = velocity_z_.update(wanted_H.z(), velocity_H.z(), kPositionPeriod_s);
  memory_.thrust = std::clamp(gains_.thrust_base + gains_.thrust_per_output * up, gains_.thrust_min, gains_.full);
}

RotorValues Controller::control_attitude(const RigidState& state, const Eigen::Vector3d& attitude_deg) {
  const Eigen::Vector3d rate_deg_per_s = kDegrees * state.body_rate_rad_per_s();
  const Eigen::Vector3d& wanted_deg = memory_.attitude_deg;
  Demand demand;
  demand.thrust = memory_.thrust;
  demand.roll = roll_rate_.update(roll_.update(wanted_deg.x(), attitude_deg.x(), kAttitudePeriod_s), rate_deg_per_s.x(),
                                  kAttitudePeriod_s);
  demand.pitch = pitch_rate_.update(pitch_.update(wanted_deg.y(), attitude_deg.y(), kAttitudePeriod_s),
                                    rate_deg_per_s.y(), kAttitudePeriod_s);
  demand.yaw = yaw_rate_.update(yaw_.update(wanted_deg.z(), attitude_deg.z(), kAttitudePeriod_s), rate_deg_per_s.z(),
                                kAttitudePeriod_s);
  return distributed(demand);
}

const RotorValues& Controller::update(const StabiliserGoal& goal, const RigidState& state, std::int64_t time_ns,
                                      double bus_voltage_v) {
  if (!goal.motors_on) {
    memory_ = {};
    return memory_.command;
  }
  const std::int64_t attitude_tick = period_at(time_ns, kAttitudePeriod_ns);
  if (memory_.running && attitude_tick == memory_.attitude_tick) return memory_.command;
  const Attitude attitude = attitude_of(state.rotation());
  const Eigen::Vector3d attitude_deg =
      kDegrees * Eigen::Vector3d(attitude.roll_rad, attitude.pitch_rad, attitude.yaw_rad);
  if (!memory_.running) start(goal, state, attitude_deg);
  memory_.attitude_tick = attitude_tick;

  if (!goal.hold_place) {
    memory_.attitude_deg.z() =
        std::remainder(memory_.attitude_deg.z() + kDegrees * goal.yaw_rate_rad_per_s * kAttitudePeriod_s, 360.0);
  }
  const std::int64_t position_tick = period_at(time_ns, kPositionPeriod_ns);
  if (position_tick != memory_.position_tick) {
    memory_.position_tick = position_tick;
    control_position(goal, state, attitude.yaw_rad);
  }
  RotorValues shares = control_attitude(state, attitude_deg);
  if (bus_voltage_v >= kLeastSupply_v) {
    for (double& share : shares) share = compensated(share, bus_voltage_v, *rotor_);
  }
  memory_.command = capped(shares);
  return memory_.command;
}

void Controller::visit(state::Visitor& v) {
  v("running", memory_.running);
  v("holding", memory_.holding);
  v("hold_W_m", numbers(memory_.hold_W_m));
  v("altitude_m", memory_.altitude_m);
  v("attitude_deg", numbers(memory_.attitude_deg));
  v("thrust", memory_.thrust);
  v("attitude_tick", memory_.attitude_tick);
  v("position_tick", memory_.position_tick);
  v("command", memory_.command);
  v("roll_rate", roll_rate_);
  v("pitch_rate", pitch_rate_);
  v("yaw_rate", yaw_rate_);
  v("roll", roll_);
  v("pitch", pitch_);
  v("yaw", yaw_);
  v("velocity_x", velocity_x_);
  v("velocity_y", velocity_y_);
  v("velocity_z", velocity_z_);
  v("position_x", position_x_);
  v("position_y", position_y_);
  v("position_z", position_z_);
}

}  // namespace mebots::world::crazyflie
