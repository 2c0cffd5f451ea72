// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace mebots::world {

/// What the stabiliser is asked for.
struct StabiliserGoal {
  bool motors_on = false;
  bool hold_place = false;       ///< brake, then hold the place reached; velocity and yaw rate are not used
  double forward_m_per_s = 0.0;  ///< in the heading frame
  double left_m_per_s = 0.0;
  double yaw_rate_rad_per_s = 0.0;
  bool descend = false;     ///< sink at the descent speed; altitude is not used
  double altitude_m = 0.0;  ///< of the body's centre above z = 0
};

}  // namespace mebots::world
