// SPDX-License-Identifier: Apache-2.0
#include "stabiliser/stabiliser.hpp"

#include "dynamics/rigid_world.hpp"
#include "math/rotation.hpp"

#include <algorithm>
#include <cmath>

namespace mebots::world {
namespace {

/// When the speed of a braking drone falls below this value, the drone holds its position.
constexpr double kStoppedSpeed_m_per_s = 0.05;
/// If the drone's underside is lower than this, the drone starts on the ground.
constexpr double kOnGround_m = 0.01;

Eigen::Vector3d limited_horizontally(const Eigen::Vector3d& v, double limit) {
  const double length = v.head<2>().norm();
  if (length <= limit) return v;
  return {v.x() * limit / length, v.y() * limit / length, v.z()};
}

}  // namespace

Stabiliser::Stabiliser(const scene::Drone& drone)
    : drone_(drone), curve_(drone.thrust_curve), gains_(Gains::for_lag(drone.rotor_lag_s)) {}

void Stabiliser::set_mass(double mass_kg, const Eigen::Vector3d& inertia_kg_m2) {
  mass_kg_ = mass_kg;
  inertia_kg_m2_ = inertia_kg_m2;
}

void Stabiliser::start(const RigidState& state, double yaw_rad) {
  memory_ = {};
  memory_.running = true;
  memory_.starting = drone_.start_time_s > 0.0 && state.p_WB_m.z() < 0.5 * drone_.body_size_m.z() + kOnGround_m;
  memory_.heading_rad = yaw_rad;
  memory_.velocity_H_m_per_s = yaw_rotation(-yaw_rad) * state.v_WB_m_per_s;
  memory_.last_rate_B_rad_per_s = state.body_rate_rad_per_s();
}

/// Returns the greatest thrust of one rotor. It is lower during the start, because full commands at standstill would
/// draw more current than a cell can deliver.
double Stabiliser::greatest_thrust_n(double dt_s) {
  if (!memory_.starting) return curve_.max_thrust_n();
  const double share = memory_.since_start_s / drone_.start_time_s;
  memory_.since_start_s += dt_s;
  memory_.starting = share < 1.0;
  return curve_.thrust_for(drone_.start_command + std::min(share, 1.0) * (1.0 - drone_.start_command));
}

Eigen::Vector3d Stabiliser::wanted_velocity(const StabiliserGoal& goal, const RigidState& state, double yaw_rad) {
  Eigen::Vector3d wanted_H{goal.forward_m_per_s, goal.left_m_per_s, 0.0};
  if (goal.hold_place) {
    if (!memory_.holding && state.v_WB_m_per_s.head<2>().norm() < kStoppedSpeed_m_per_s) {
      memory_.holding = true;
      memory_.hold_W_m = state.p_WB_m;
    }
    const Eigen::Vector3d back_W = memory_.holding
                                       ? Eigen::Vector3d(gains_.position_per_s * (memory_.hold_W_m - state.p_WB_m))
                                       : Eigen::Vector3d::Zero();
    wanted_H = limited_horizontally(yaw_rotation(-yaw_rad) * back_W, gains_.max_hold_speed_m_per_s);
  } else {
    memory_.holding = false;
  }
  wanted_H.z() = goal.descend ? -gains_.max_descent_m_per_s
                              : std::clamp(gains_.altitude_per_s * (goal.altitude_m - state.p_WB_m.z()),
                                           -gains_.max_descent_m_per_s, gains_.max_climb_m_per_s);
  return wanted_H;
}

Eigen::Vector3d Stabiliser::wanted_acceleration(const StabiliserGoal& goal, const RigidState& state, double yaw_rad,
                                                double dt_s) {
  // Moves the reference velocity to the wanted velocity only as fast as the closed loop can follow. Therefore the
  // integrator only compensates wind, voltage sag and errors of the model's constants.
  const Eigen::Vector3d follow_per_s{gains_.velocity_p_per_s, gains_.velocity_p_per_s, gains_.climb_p_per_s};
  const Eigen::Vector3d pull_H = limited_horizontally(
      follow_per_s.cwiseProduct(wanted_velocity(goal, state, yaw_rad) - memory_.velocity_H_m_per_s),
      kGravity_m_per_s2 * std::tan(gains_.max_tilt_rad));
  memory_.velocity_H_m_per_s += dt_s * pull_H;

  const Eigen::Quaterniond R_WH = yaw_rotation(yaw_rad);
  const double turn_rad_per_s = goal.hold_place ? 0.0 : goal.yaw_rate_rad_per_s;
  const Eigen::Vector3d turn_H = turn_rad_per_s * Eigen::Vector3d::UnitZ().cross(memory_.velocity_H_m_per_s);
  const Eigen::Vector3d error_W = R_WH * memory_.velocity_H_m_per_s - state.v_WB_m_per_s;

  const Eigen::Vector3d integral_gain{gains_.velocity_i_per_s2, gains_.velocity_i_per_s2, gains_.climb_i_per_s2};
  Eigen::Vector3d& integral = memory_.integral_W_m_per_s2;
  integral = limited_horizontally(integral + dt_s * integral_gain.cwiseProduct(error_W),
                                  gains_.max_horizontal_integral_m_per_s2);
  integral.z() =
      std::clamp(integral.z(), -gains_.max_vertical_integral_m_per_s2, gains_.max_vertical_integral_m_per_s2);

  // Adds the drag at the reference velocity in still air, so that the integrator need not compensate it.
  const Eigen::Vector3d drag_H = drone_.drag_n_s_per_m.cwiseProduct(memory_.velocity_H_m_per_s) / mass_kg_;
  const Eigen::Vector3d wanted_W = R_WH * (pull_H + turn_H + drag_H) + follow_per_s.cwiseProduct(error_W) + integral;
  return limited_horizontally(wanted_W, kGravity_m_per_s2 * std::tan(gains_.max_tilt_rad));
}

Eigen::Vector3d Stabiliser::wanted_torque(const StabiliserGoal& goal, const RigidState& state, double yaw_rad,
                                          const Eigen::Vector3d& up_W, double dt_s) {
  const Eigen::Vector3d rate_B = state.body_rate_rad_per_s();
  const Eigen::Vector3d measured_B = (rate_B - memory_.last_rate_B_rad_per_s) / dt_s;
  memory_.last_rate_B_rad_per_s = rate_B;
  memory_.acceleration_B_rad_per_s2 +=
      dt_s / (gains_.acceleration_filter_s + dt_s) * (measured_B - memory_.acceleration_B_rad_per_s2);

  // Computes the shortest rotation from the body's z axis to the wanted direction, as a vector in body axes.
  const Eigen::Vector3d up_B = state.q_WB.conjugate() * up_W;
  const Eigen::Vector3d axis_B = Eigen::Vector3d::UnitZ().cross(up_B);
  const double sine = axis_B.norm();
  const double angle = std::atan2(sine, up_B.z());
  const Eigen::Vector3d tilt_error_B =
      sine > 1e-12 ? Eigen::Vector3d(axis_B * (angle / sine)) : Eigen::Vector3d::Zero();

  const double turn_rad_per_s = goal.hold_place ? 0.0 : goal.yaw_rate_rad_per_s;
  // The heading follows a wanted yaw rate with the lag 1 / yaw_pole_per_s. The reference heading has the same lag, so
  // that the heading does not overshoot.
  memory_.yaw_rate_rad_per_s += dt_s * gains_.yaw_pole_per_s * (turn_rad_per_s - memory_.yaw_rate_rad_per_s);
  const double lead_rad = std::clamp(wrapped_rad(memory_.heading_rad + dt_s * memory_.yaw_rate_rad_per_s - yaw_rad),
                                     -gains_.max_yaw_lead_rad, gains_.max_yaw_lead_rad);
  memory_.heading_rad = wrapped_rad(yaw_rad + lead_rad);

  Eigen::Vector3d wanted_rate_B = gains_.tilt.angle_per_s * tilt_error_B;
  const double tilt_rate = wanted_rate_B.norm();
  if (tilt_rate > gains_.max_rate_rad_per_s) wanted_rate_B *= gains_.max_rate_rad_per_s / tilt_rate;
  wanted_rate_B.z() = turn_rad_per_s + gains_.yaw.angle_per_s * lead_rad;

  const Eigen::Vector3d rate_gain{gains_.tilt.rate_per_s, gains_.tilt.rate_per_s, gains_.yaw.rate_per_s};
  const Eigen::Vector3d acceleration_gain{gains_.tilt.acceleration, gains_.tilt.acceleration, gains_.yaw.acceleration};
  const Eigen::Vector3d acceleration_B = rate_gain.cwiseProduct(wanted_rate_B - rate_B) -
                                         acceleration_gain.cwiseProduct(memory_.acceleration_B_rad_per_s2);
  return inertia_kg_m2_.cwiseProduct(acceleration_B);
}

const RotorValues& Stabiliser::update(const StabiliserGoal& goal, const RigidState& state, double dt_s) {
  if (!goal.motors_on) {
    memory_ = {};
    return memory_.command;
  }
  const Eigen::Matrix3d R_WB = state.rotation();
  const double yaw_rad = attitude_of(R_WB).yaw_rad;
  if (!memory_.running) start(state, yaw_rad);

  const Eigen::Vector3d lift_W =
      wanted_acceleration(goal, state, yaw_rad, dt_s) + Eigen::Vector3d(0.0, 0.0, kGravity_m_per_s2);
  // Limits the acceleration to less than gravity downwards. This also keeps the direction of the thrust well defined.
  const Eigen::Vector3d held_W{lift_W.x(), lift_W.y(),
                               std::max(lift_W.z(), gains_.min_thrust_share * kGravity_m_per_s2)};
  const Eigen::Vector3d up_W = limited_horizontally(held_W, held_W.z() * std::tan(gains_.max_tilt_rad)).normalized();
  const double collective_n = mass_kg_ * std::max(held_W.dot(R_WB.col(2)), gains_.min_thrust_share * kGravity_m_per_s2);
  const Eigen::Vector3d torque_B = wanted_torque(goal, state, yaw_rad, up_W, dt_s);

  const RotorValues thrust = mix(drone_, greatest_thrust_n(dt_s), collective_n, torque_B);
  for (std::size_t i = 0; i < kRotors; ++i) memory_.command[i] = curve_.command_for(thrust[i]);
  return memory_.command;
}

void Stabiliser::visit(state::Visitor& v) {
  v("running", memory_.running);
  v("starting", memory_.starting);
  v("since_start_s", memory_.since_start_s);
  v("holding", memory_.holding);
  v("hold_W_m", numbers(memory_.hold_W_m));
  v("heading_rad", memory_.heading_rad);
  v("yaw_rate_rad_per_s", memory_.yaw_rate_rad_per_s);
  v("velocity_H_m_per_s", numbers(memory_.velocity_H_m_per_s));
  v("integral_W_m_per_s2", numbers(memory_.integral_W_m_per_s2));
  v("last_rate_B_rad_per_s", numbers(memory_.last_rate_B_rad_per_s));
  v("acceleration_B_rad_per_s2", numbers(memory_.acceleration_B_rad_per_s2));
  v("command", memory_.command);
}

Gains::Rotation Gains::rotation(double pole_per_s, double lag_s) {
  // Equates the coefficients of (s + p)^3 = s^3 + 3 p s^2 + 3 p^2 s + p^3 and of s^3 + (1 + k_a) / T s^2 + k_r / T s +
  // k_r k_angle / T.
  const double rate = 3.0 * lag_s * pole_per_s * pole_per_s;
  return {pole_per_s / 3.0, rate, std::max(0.0, 3.0 * lag_s * pole_per_s - 1.0)};
}

Gains Gains::for_lag(double rotor_lag_s) {
  Gains gains{};
  // If the rotor's lag is below 1 / (3 pole), uses 1 / (3 pole), because such a short lag is negligible.
  gains.tilt = rotation(gains.tilt_pole_per_s, std::max(rotor_lag_s, 1.0 / (3.0 * gains.tilt_pole_per_s)));
  gains.yaw = rotation(gains.yaw_pole_per_s, std::max(rotor_lag_s, 1.0 / (3.0 * gains.yaw_pole_per_s)));
  return gains;
}

namespace {

using Point = scene::ThrustPoint;

/// Interpolates linearly between the points: returns the value of the member `to` where the member `from` has the value
/// x.
double between(const std::vector<Point>& points, double Point::*from, double Point::*to, double x) {
  const auto above = std::upper_bound(points.begin() + 1, points.end() - 1, x,
                                      [from](double value, const Point& point) { return value < point.*from; });
  const Point& b = *above;
  const Point& a = *(above - 1);
  return a.*to + (b.*to - a.*to) * (x - a.*from) / (b.*from - a.*from);
}

}  // namespace

double ThrustCurve::command_for(double thrust_n) const {
  return between(points_, &Point::thrust_n, &Point::command, thrust_n);
}

double ThrustCurve::thrust_for(double command) const {
  return between(points_, &Point::command, &Point::thrust_n, command);
}

}  // namespace mebots::world
