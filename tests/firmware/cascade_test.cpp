// SPDX-License-Identifier: Apache-2.0
//
// Compares two cascades of PID controllers, fed with the same states and set-points: the flight controller's firmware
// (pid_controller.c, in floats) and fmu_world's stabiliser.controller = crazyflie (in doubles).
//
// The two cascades give different commands, because they differ in position control, loop period, filter and constants.
// The class Cascade below is a reference in doubles. With the firmware's settings, it must give the firmware's
// commands. With fmu_world's settings, it must give fmu_world's commands. So all differences come from the settings.
// The test prints how much each setting contributes.
#include "crazyflie/controller.hpp"
#include "flight/controller.h"

#include <fmt/core.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

namespace mebots::firmware {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kFull = 65535;
constexpr double kNone = 1e9;

struct PidSettings {
  double kp;
  double ki;
  double kd;
  double most_integral;  // of the error
  double most_output;
};

/// The units are rad, m, s and shares of a motor's full command.
struct Settings {
  PidSettings rate;
  PidSettings angle;
  PidSettings yaw_rate;
  PidSettings yaw;
  PidSettings velocity;
  PidSettings climb;
  PidSettings height;
  double place;  // [1/s]
  double hover_share;
  double least_share;
  double most_tilt;
  double rate_filter;  // share of a new sample of the gyroscope
  int period_ms;       // of the loops of angle and rate
};

/// The constants of pid_controller.c.
constexpr Settings kFirmware{.rate = {0.2186, 0.4371, 0.002186, 0.58, kNone},
                             .angle = {6, 3, 0, 0.35, kNone},
                             .yaw_rate = {0.1049, 0.0146, 0, 2.9, kNone},
                             .yaw = {6, 1, 0, 6.28, kNone},
                             .velocity = {0.436, 0.15, 0, 1.5, kNone},
                             .climb = {0.3815, 0.2289, 0, 1.5, kNone},
                             .height = {2, 0, 0, kNone, 1.1},
                             .place = 1,
                             .hover_share = 0.549,
                             .least_share = 0.305,
                             .most_tilt = 0.35,
                             .rate_filter = 0.395,
                             .period_ms = 1};

/// The Crazyflie's published gains (platform_defaults_cf2.h, commit 2a18fc29), converted to the units of Settings. The
/// position gain is 0, because fmu_world's cascade does not control the position.
constexpr Settings kCrazyflie{
    .rate = {250 / kFull / kDegree, 500 / kFull / kDegree, 2.5 / kFull / kDegree, 33.3 * kDegree, kNone},
    .angle = {6, 3, 0, 20 * kDegree, kNone},
    .yaw_rate = {120 / kFull / kDegree, 16.7 / kFull / kDegree, 0, 166.7 * kDegree, kNone},
    .yaw = {6, 1, 0.35, 360 * kDegree, kNone},
    .velocity = {25 * kDegree, 1 * kDegree, 0, 5000, 22 * kDegree},
    .climb = {25e3 / kFull, 15e3 / kFull, 0, 5000, 32767 / kFull},
    .height = {2, 0.5, 0, 5000, 1.1},
    .place = 0,
    .hover_share = 36000 / kFull,
    .least_share = 20000 / kFull,
    .most_tilt = 20 * kDegree,
    .rate_filter = 1,
    .period_ms = 2};

/// The state of the drone at a time: roll, yaw, height and velocities with their derivatives. Pitch is always 0,
/// because the controllers treat pitch and roll alike.
struct Sample {
  double roll, yaw;
  double roll_rate, yaw_rate;  // of the body
  double height, climb;
  double forward, left;  // velocities
};

class Pid {
 public:
  explicit Pid(const PidSettings& settings) : settings_(&settings) {}
  void reset(double measured) { last_ = measured; }
  double update(double error, double measured, double dt) {
    const auto& s = *settings_;
    integral_ = std::clamp(integral_ + error * dt, -s.most_integral, s.most_integral);
    const double slope = (measured - last_) / dt;
    last_ = measured;
    return std::clamp(s.kp * error + s.ki * integral_ - s.kd * slope, -s.most_output, s.most_output);
  }

 private:
  const PidSettings* settings_;
  double integral_ = 0;
  double last_ = 0;
};

/// The set-points of all flights. The yaw set-point is constant.
constexpr double kForward = 0.2;
constexpr double kHeight = 1.0;

class Cascade {
 public:
  explicit Cascade(const Settings& settings) : s_(settings) {}

  const std::array<double, 4>& update(const Sample& now, int time_ms) {
    if (time_ms % s_.period_ms != 0) return command_;
    const double dt = 0.001 * s_.period_ms;
    roll_rate_filtered_ += s_.rate_filter * (now.roll_rate - roll_rate_filtered_);
    yaw_rate_filtered_ += s_.rate_filter * (now.yaw_rate - yaw_rate_filtered_);
    if (time_ms % 10 == 0) control_position(now);
    const double roll_speed = roll_.update(wanted_roll_ - now.roll, now.roll, dt);
    const double pitch_speed = pitch_.update(wanted_pitch_, 0, dt);
    const double yaw_speed = yaw_.update(-now.yaw, now.yaw, dt);
    const double r = 0.5 * roll_rate_.update(roll_speed - roll_rate_filtered_, roll_rate_filtered_, dt);
    const double p = 0.5 * pitch_rate_.update(pitch_speed, 0, dt);
    const double y = yaw_rate_.update(yaw_speed - yaw_rate_filtered_, yaw_rate_filtered_, dt);
    command_ = {thrust_ - r - p - y, thrust_ - r + p + y, thrust_ + r + p - y, thrust_ + r - p + y};
    return command_;
  }

 private:
  /// Controls velocities and height. The horizontal position is not controlled: the firmware's goal is always the
  /// drone's own position, and fmu_world's cascade has no position control.
  void control_position(const Sample& now) {
    constexpr double kDt = 0.01;
    const double wanted_climb = height_.update(kHeight - now.height, now.height, kDt);
    const double c = std::cos(now.yaw);
    const double s = std::sin(now.yaw);
    // Errors of the velocity (wanted minus measured) in the heading frame. `now` contains the measured velocity in the
    // world frame, whose axes are those of yaw = 0.
    const double forward = kForward - (c * now.forward + s * now.left);
    const double left = -(c * now.left - s * now.forward);
    wanted_pitch_ = std::clamp(velocity_x_.update(forward, 0, kDt), -s_.most_tilt, s_.most_tilt);
    wanted_roll_ = std::clamp(-velocity_y_.update(left, 0, kDt), -s_.most_tilt, s_.most_tilt);
    thrust_ = std::clamp(s_.hover_share + climb_.update(wanted_climb - now.climb, 0, kDt), s_.least_share, 1.0);
  }

  const Settings s_;
  Pid roll_{s_.angle}, pitch_{s_.angle}, yaw_{s_.yaw};
  Pid roll_rate_{s_.rate}, pitch_rate_{s_.rate}, yaw_rate_{s_.yaw_rate};
  Pid velocity_x_{s_.velocity}, velocity_y_{s_.velocity}, climb_{s_.climb}, height_{s_.height};
  double roll_rate_filtered_ = 0, yaw_rate_filtered_ = 0;
  double wanted_roll_ = 0, wanted_pitch_ = 0, thrust_ = 0;
  std::array<double, 4> command_{};
};

/// Returns the motion of a flight. All motions start at rest, so that no derivative starts with a step.
Sample sample_at(int time_ms) {
  const double t = 0.001 * time_ms;
  const auto swing = [&](double size, double frequency_hz) {
    return size * (1 - std::cos(2 * std::numbers::pi * frequency_hz * t));
  };
  const auto slope = [&](double size, double frequency_hz) {
    const double w = 2 * std::numbers::pi * frequency_hz;
    return size * w * std::sin(w * t);
  };
  Sample now{};
  now.roll = swing(0.02, 3);
  now.yaw = swing(0.01, 0.7);
  now.roll_rate = slope(0.02, 3);
  // From Euler's equations with pitch 0, the rates about the body's axes y and z are yaw' sin(roll) and yaw' cos(roll).
  // The rate about y is neglected here.
  now.yaw_rate = slope(0.01, 0.7) * std::cos(now.roll);
  now.height = kHeight - swing(0.03, 0.5);
  now.climb = -slope(0.03, 0.5);
  now.forward = kForward - swing(0.05, 0.4);
  now.left = swing(0.03, 0.6);
  return now;
}

using Commands = std::vector<std::array<double, 4>>;
constexpr int kTime_ms = 4000;

Commands of_cascade(const Settings& settings) {
  Cascade cascade(settings);
  Commands commands;
  for (int t = 0; t < kTime_ms; ++t) commands.push_back(cascade.update(sample_at(t), t));
  return commands;
}

Commands of_firmware() {
  Commands commands;
  controller_init();
  for (int t = 0; t < kTime_ms; ++t) {
    const auto now = sample_at(t);
    flight_state_t state{};
    state.tick = static_cast<std::uint32_t>(t);
    state.position.z = static_cast<float>(now.height);
    state.velocity = {static_cast<float>(now.forward), static_cast<float>(now.left), static_cast<float>(now.climb)};
    state.roll = static_cast<float>(now.roll);
    state.yaw = static_cast<float>(now.yaw);
    state.rate = {static_cast<float>(now.roll_rate), 0, static_cast<float>(now.yaw_rate)};
    flight_goal_t goal{};
    goal.position.z = static_cast<float>(kHeight);
    goal.velocity.x = static_cast<float>(kForward * std::cos(now.yaw));
    goal.velocity.y = static_cast<float>(kForward * std::sin(now.yaw));
    std::array<float, 4> command{};
    controller_update(&goal, &state, t == 0, command.data());
    commands.push_back({command[0], command[1], command[2], command[3]});
  }
  return commands;
}

Commands of_world() {
  world::crazyflie::Controller controller(world::Propellers::legacy);
  const world::StabiliserGoal goal{.motors_on = true, .forward_m_per_s = kForward, .altitude_m = kHeight};
  Commands commands;
  for (int t = 0; t < kTime_ms; ++t) {
    const auto now = sample_at(t);
    world::RigidState state;
    state.p_WB_m.z() = now.height;
    state.v_WB_m_per_s = {now.forward, now.left, now.climb};
    state.q_WB =
        Eigen::AngleAxisd(now.yaw, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(now.roll, Eigen::Vector3d::UnitX());
    state.w_WB_W_rad_per_s = state.q_WB * Eigen::Vector3d(now.roll_rate, 0, now.yaw_rate);
    constexpr double kNoBattery = 0;  // no compensation
    commands.push_back(controller.update(goal, state, std::int64_t{t} * 1'000'000, kNoBattery));
  }
  return commands;
}

double largest_difference(const Commands& a, const Commands& b) {
  double most = 0;
  for (std::size_t t = 0; t < a.size(); ++t) {
    for (std::size_t i = 0; i < 4; ++i) most = std::max(most, std::abs(a[t][i] - b[t][i]));
  }
  return most;
}

TEST(Cascade, FirmwareIsTheReferenceWithItsSettings) {
  // The firmware computes in floats of up to 2, with rounding errors of at most 6e-8 each. Integrals have 4000 terms.
  EXPECT_LT(largest_difference(of_firmware(), of_cascade(kFirmware)), 2e-5);
}

TEST(Cascade, StabiliserIsTheReferenceWithTheCrazyfliesSettings) {
  EXPECT_LT(largest_difference(of_world(), of_cascade(kCrazyflie)), 1e-9);
}

TEST(Cascade, SettingsExplainTheWholeDifference) {
  const auto firmware = of_cascade(kFirmware);
  const auto print = [](const std::string& name, double difference) {
    fmt::print("{:<52} {:.6f}\n", name, difference);
  };
  const auto part = [&](const std::string& name, const std::function<void(Settings&)>& change) {
    auto settings = kFirmware;
    change(settings);
    print(name, largest_difference(firmware, of_cascade(settings)));
  };
  fmt::print("Largest difference of a command (share) if one setting of the firmware is the Crazyflie's:\n");
  part("loop of angle and rate: 2 ms instead of 1 ms", [](Settings& s) { s.period_ms = kCrazyflie.period_ms; });
  part("no filter of the gyroscope instead of 80 Hz", [](Settings& s) { s.rate_filter = kCrazyflie.rate_filter; });
  part("integral of the velocity: 0.017 instead of 0.15 /s",
       [](Settings& s) { s.velocity.ki = kCrazyflie.velocity.ki; });
  part("integral of the height: 0.5 instead of 0 /s2", [](Settings& s) { s.height.ki = kCrazyflie.height.ki; });
  part("derivative of the yaw: 0.35 instead of 0", [](Settings& s) { s.yaw.kd = kCrazyflie.yaw.kd; });
  part("rounded constants", [](Settings& s) {
    s.rate = kCrazyflie.rate;
    s.yaw_rate = kCrazyflie.yaw_rate;
    s.velocity.kp = kCrazyflie.velocity.kp;
    s.climb = kCrazyflie.climb;
    s.hover_share = kCrazyflie.hover_share;
  });
  const double whole = largest_difference(of_firmware(), of_world());
  print("all, firmware compared with fmu_world", whole);
  EXPECT_GT(whole, 1e-4) << "they are different cascades";

  auto settings = kFirmware;
  settings.period_ms = kCrazyflie.period_ms;
  settings.rate_filter = kCrazyflie.rate_filter;
  settings.velocity.ki = kCrazyflie.velocity.ki;
  settings.height.ki = kCrazyflie.height.ki;
  settings.yaw.kd = kCrazyflie.yaw.kd;
  // The remaining difference is rounding: the firmware's constants have two to four digits, with relative errors of up
  // to 8e-4.
  EXPECT_LT(largest_difference(of_cascade(settings), of_world()), 1e-3);
}

}  // namespace
}  // namespace mebots::firmware
