// SPDX-License-Identifier: Apache-2.0
#include "crazyflie/power_distribution.hpp"

#include <algorithm>

namespace mebots::world::crazyflie {
namespace {

constexpr double kFull = 65535.0;
// Of a rotor with legacy propellers, over its motor's voltage: crazyflie-firmware, platform_defaults_cf2.h.
constexpr double kConstant_n = -0.014830744918356092;
constexpr double kLinear_n_per_v = 0.04724465241828281;
constexpr double kSquare_n_per_v2 = -0.01847364358025878;
constexpr double kCubic_n_per_v3 = 0.005960923942142;
constexpr double kLeast_n = 0.012817578393224994;
constexpr double kMost_n = 0.12;

/// The cubic rises everywhere and is convex above 1.03 V, so Newton's steps from 4 V come down to the root.
double motor_voltage_v(double thrust_n) {
  double v = 4.0;
  constexpr int kSteps = 16;
  for (int i = 0; i < kSteps; ++i) {
    const double thrust_at_v = kConstant_n + v * (kLinear_n_per_v + v * (kSquare_n_per_v2 + v * kCubic_n_per_v3));
    const double slope = kLinear_n_per_v + v * (2.0 * kSquare_n_per_v2 + v * 3.0 * kCubic_n_per_v3);
    v -= (thrust_at_v - thrust_n) / slope;
  }
  return v;
}

}  // namespace

RotorValues distributed(const Demand& demand) {
  RotorValues shares{};
  for (std::size_t i = 0; i < kRotors; ++i) {
    shares[i] = (demand.thrust + 0.5 * kRotorY[i] * demand.roll - 0.5 * kRotorX[i] * demand.pitch +
                 kRotorYawSign[i] * demand.yaw) /
                kFull;
  }
  return shares;
}

double compensated(double share, double supply_v) {
  const double thrust_n = kMost_n * share;
  return thrust_n < kLeast_n ? 0.0 : motor_voltage_v(thrust_n) / supply_v;
}

RotorValues capped(const RotorValues& shares) {
  const double excess = std::max(0.0, *std::max_element(shares.begin(), shares.end()) - 1.0);
  RotorValues command{};
  for (std::size_t i = 0; i < kRotors; ++i) command[i] = std::clamp(shares[i] - excess, 0.0, 1.0);
  return command;
}

}  // namespace mebots::world::crazyflie
