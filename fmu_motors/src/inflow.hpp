// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace mebots::motors {

/// Flow through a rotor's disc in Glauert's momentum theory.
struct Inflow {
  double thrust_n = 0;           ///< >= 0
  double density_kg_per_m3 = 0;  ///< > 0
  double radius_m = 0;           ///< radius of the disc, > 0
  double speed_m_per_s = 0;      ///< speed of the air along the disc, >= 0
  double climb_m_per_s = 0;      ///< speed of the air through the disc from above, positive = climbing

  /// Returns v_h = sqrt(F / (2 rho A)) [m/s].
  double hover_velocity() const;
  /// Returns the induced velocity v_i [m/s], which satisfies v_i sqrt(V^2 + (V_c + v_i)^2) = v_h^2. The theory is not
  /// valid where a descending rotor meets its own wake. Therefore a V_c below -v_h is replaced by -v_h.
  double induced_velocity() const;
  /// Returns the aerodynamic power minus that of hovering with the same thrust: F (V_c + v_i - v_h) [W].
  double power_beyond_hover_w() const;
};

}  // namespace mebots::motors
