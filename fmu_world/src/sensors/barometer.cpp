// SPDX-License-Identifier: Apache-2.0
#include "sensors/barometer.hpp"

#include "dynamics/rigid_world.hpp"
#include "math/rounding.hpp"
#include "noise/counter_noise.hpp"

#include <algorithm>
#include <cmath>

namespace mebots::world {

double pressure_at(const Air& air, double height_m) {
  constexpr double kLapse_k_per_m = 0.0065;
  constexpr double kGasConstant_j_per_kg_k = 287.05287;  // of dry air
  constexpr double kExponent = kGravity_m_per_s2 / (kGasConstant_j_per_kg_k * kLapse_k_per_m);
  const double share = std::max(0.0, 1.0 - kLapse_k_per_m * height_m / air.temperature_k);
  return air.pressure_pa * std::pow(share, kExponent);
}

Barometer::Barometer(const scene::BarometerData& data, const Air& air, std::uint64_t seed)
    : data_(data), air_(air), clock_(data.period_s), seed_(seed) {}

void Barometer::update(std::int64_t time_ns, double height_m) {
  if (!clock_.advance(time_ns)) return;
  const double bias_pa = data_.bias_pa * noise::gaussian(seed_, noise::Stream::barometer_bias, 0);
  const double noise_pa = data_.noise_pa * noise::gaussian(seed_, noise::Stream::barometer, clock_.number());
  pressure_pa_ = rounded(pressure_at(air_, height_m) + bias_pa + noise_pa, data_.resolution_pa);
}

void Barometer::visit(state::Visitor& v) {
  v("clock", clock_);
  v("pressure_pa", pressure_pa_);
}

}  // namespace mebots::world
