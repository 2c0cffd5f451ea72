// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "rotor_data.hpp"

namespace mebots::motors {

inline constexpr double kGravity = 9.80665;  // standard gravity [m/s^2]

/// Power model of the MEbots paper, in the paper's symbols.

/// Returns P_hover = m g p n / eta [W], where p is the propeller's pitch and eta the efficiency of motor and propeller.
/// n is the number of turns per second at which four rotors lift the mass at that air density: 4 k (rho / rho_0) (2 pi
/// n)^2 = m g.
double hover_power_w(const RotorData& rotor, double mass_kg, double density_kg_per_m3);

/// Returns P_propel = m g v / (eta r) [W], where r is the ratio of lift to drag (D'Andrea 2014).
double propel_power_w(const RotorData& rotor, double mass_kg, double speed_m_per_s);

}  // namespace mebots::motors
