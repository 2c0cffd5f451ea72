// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/sample_clock.hpp"
#include "mebots/state/visitor.hpp"
#include "scene/sensor_data.hpp"

#include <cstdint>

namespace mebots::world {

/// The air at z = 0.
struct Air {
  double pressure_pa = 101325.0;
  double temperature_k = 288.15;
};

/// Returns the static pressure at a height in the standard atmosphere (ISO 2533:1975, below 11 km): the temperature
/// falls by 6.5 K per kilometre, and the air is in hydrostatic equilibrium.
double pressure_at(const Air& air, double height_m);

/// Measures the static pressure at the drone's centre: truth + constant bias + normal noise, rounded to the resolution.
/// Ignores the flow around the drone and its propellers.
class Barometer {
 public:
  Barometer(const scene::BarometerData& data, const Air& air, std::uint64_t seed);

  /// Saved states do not contain the seed, so DroneSensors sets it before every step.
  void reseed(std::uint64_t seed) { seed_ = seed; }

  void update(std::int64_t time_ns, double height_m);

  double pressure_pa() const { return pressure_pa_; }

  void visit(state::Visitor& v);

 private:
  scene::BarometerData data_;
  Air air_;
  SampleClock clock_;
  std::uint64_t seed_;
  double pressure_pa_ = 0.0;
};

}  // namespace mebots::world
