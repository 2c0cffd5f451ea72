// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "crazyflie/pid.hpp"

namespace mebots::world::crazyflie {

/// The published gains of the Crazyflie 2.x, in the firmware's units: degrees, m, s, and 1/65535 of a motor's full
/// command. Source: bitcraze/crazyflie-firmware, commit 2a18fc29 (August 2026),
/// src/platform/interface/platform_defaults_cf2.h (gains, limits), platform_defaults.h (filters),
/// src/modules/src/controller/position_controller_pid.c (thrust_per_output; output limits of 110 % of the greatest tilt
/// and of the greatest speeds). The firmware also filters derivatives. For velocity and position, this filter is
/// omitted here, because all kd are 0.
struct Gains {
  PidGains roll_rate{.kp = 250.0, .ki = 500.0, .kd = 2.5, .integral_limit = 33.3, .output_limit = 32767.0};
  PidGains pitch_rate = roll_rate;
  PidGains yaw_rate{.kp = 120.0, .ki = 16.7, .integral_limit = 166.7, .output_limit = 32767.0};

  PidGains roll{.kp = 6.0, .ki = 3.0, .integral_limit = 20.0};
  PidGains pitch = roll;
  PidGains yaw{.kp = 6.0, .ki = 1.0, .kd = 0.35, .integral_limit = 360.0, .wraps = true};

  double max_tilt_deg = 20.0;
  PidGains velocity_xy{.kp = 25.0, .ki = 1.0, .output_limit = 22.0};
  PidGains velocity_z{.kp = 25.0, .ki = 15.0, .output_limit = 32.767};
  PidGains position_xy{.kp = 2.0, .output_limit = 1.1};
  PidGains position_z{.kp = 2.0, .ki = 0.5, .output_limit = 1.1};

  double full = 65535.0;
  double thrust_per_output = 1000.0;
  double thrust_base = 36000.0;
  double thrust_min = 20000.0;

  /// Speeds of the altitude set-point if the goal is to hold the position, as in the ideal stabiliser. These values are
  /// not from the firmware.
  double climb_m_per_s = 0.5;
  double descent_m_per_s = 0.3;
};

}  // namespace mebots::world::crazyflie
