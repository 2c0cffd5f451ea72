// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace mebots::world {

/// Gains of the stabiliser. fmu_world/docs/stabiliser.md derives them.
struct Gains {
  /// Feedback of one rotation axis whose torque follows its command with a first-order lag.
  struct Rotation {
    double angle_per_s;   ///< rad/s of wanted rate per rad of error
    double rate_per_s;    ///< rad/s2 of wanted acceleration per rad/s of error
    double acceleration;  ///< rad/s2 less per rad/s2 that there is
  };
  /// The three poles of (angle, rate, acceleration) at -pole_per_s, for a torque lag of lag_s.
  /// acceleration feedback is never negative: a faster rotor than 1 / (3 pole) needs none.
  static Rotation rotation(double pole_per_s, double lag_s);

  double tilt_pole_per_s = 12.0;
  double yaw_pole_per_s = 6.0;
  Rotation tilt;
  Rotation yaw;
  double velocity_p_per_s = 1.5;
  double velocity_i_per_s2 = 0.6;
  double position_per_s = 0.6;
  double climb_p_per_s = 3.0;
  double climb_i_per_s2 = 2.0;
  double altitude_per_s = 1.2;

  double max_tilt_rad = 0.45;           ///< about 26 degrees
  double max_rate_rad_per_s = 6.0;      ///< of roll and pitch that the angle loop asks for
  double max_yaw_lead_rad = 0.5;        ///< heading reference ahead of the heading
  double max_hold_speed_m_per_s = 0.3;  ///< back to the point that is held
  double max_climb_m_per_s = 0.5;
  double max_descent_m_per_s = 0.3;
  double max_horizontal_integral_m_per_s2 = 3.0;
  double max_vertical_integral_m_per_s2 = 4.0;
  double min_thrust_share = 0.2;         ///< of the weight, so that roll and pitch keep their grip
  double acceleration_filter_s = 0.005;  ///< lag of the measured angular acceleration

  /// For a drone whose rotors follow with `rotor_lag_s`.
  static Gains for_lag(double rotor_lag_s);
};

}  // namespace mebots::world
