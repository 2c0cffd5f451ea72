// SPDX-License-Identifier: Apache-2.0
#include "link_budget.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mebots::radio {
namespace {

constexpr double kLightSpeed_m_per_s = 299792458;
constexpr double kErrorRateAtSensitivity = 1e-3;

}  // namespace

double received_power_w(const Parameters& parameters, double distance_m) {
  const double at_first_metre = kLightSpeed_m_per_s / (4 * std::numbers::pi * parameters.packet_frequency_hz);
  return parameters.packet_power_w * at_first_metre * at_first_metre *
         std::pow(std::max(distance_m, kLeastDistance_m), -parameters.packet_path_loss_exponent);
}

double loss_probability(const Parameters& parameters, double power_w, std::int32_t bits) {
  const double signal_at_sensitivity = -2 * std::log(2 * kErrorRateAtSensitivity);
  const double signal = signal_at_sensitivity * power_w / parameters.packet_sensitivity_w;
  const double error_rate = std::exp(-signal / 2) / 2;
  const double all_right = std::exp(bits * std::log1p(-error_rate));
  return 1 - all_right * (1 - parameters.packet_loss);
}

std::int32_t bits_of(const Parameters& parameters, std::int32_t size) {
  return parameters.packet_overhead + 8 * size;
}

std::int64_t airtime_ns(const Parameters& parameters, std::int32_t size) {
  return nanoseconds(bits_of(parameters, size) / parameters.packet_rate_hz);
}

std::int64_t nanoseconds(double time_s) {
  return std::llround(time_s * 1e9);
}

}  // namespace mebots::radio
