// SPDX-License-Identifier: Apache-2.0
#include "hover_propel.hpp"

#include "fmu_motors/variables.hpp"

#include <cmath>
#include <numbers>

namespace mebots::motors {

double hover_power_w(const RotorData& rotor, double mass_kg, double density_kg_per_m3) {
  const double weight_n = mass_kg * kGravity;
  const double coefficient = static_cast<double>(rotor::kCount) * rotor.thrust_coefficient_at(density_kg_per_m3);
  const double turns_per_s = std::sqrt(weight_n / coefficient) / (2 * std::numbers::pi);
  return weight_n * rotor.propeller_pitch_m * turns_per_s / rotor.propulsion_efficiency;
}

double propel_power_w(const RotorData& rotor, double mass_kg, double speed_m_per_s) {
  return mass_kg * kGravity * speed_m_per_s / (rotor.propulsion_efficiency * rotor.lift_to_drag);
}

}  // namespace mebots::motors
