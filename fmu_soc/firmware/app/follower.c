// SPDX-License-Identifier: Apache-2.0
#include "app/follower.h"

void follower_init(follower_t* follower, const policy_t* policy, int32_t yaw_rate_scale_urad_s) {
  follower->phase = PILOT_APPROACH;
  follower->behind_um = 0;
  follower->policy = *policy;
  follower->yaw_rate_scale_urad_s = yaw_rate_scale_urad_s;
}

pilot_command_t follower_step(follower_t* follower, int8_t yaw, bool crossed, int32_t forward_velocity_um_s,
                              int32_t elapsed_us) {
  if (crossed && follower->phase == PILOT_APPROACH) {
    follower->phase = PILOT_THROUGH;
  } else if (follower->phase == PILOT_THROUGH) {
    follower->behind_um += (int32_t)((int64_t)forward_velocity_um_s * elapsed_us / 1000000);
    if (follower->behind_um >= PILOT_BEHIND_MM * 1000) {
      follower->phase = PILOT_DONE;
    }
  }
  // After the gate, pictures contain no information, and the drone flies straight.
  const int8_t wanted = follower->phase == PILOT_APPROACH ? yaw : 0;
  const int32_t velocity_um_s = policy_speed_um_s(&follower->policy, wanted);
  const pilot_command_t command = {follower->phase == PILOT_DONE ? 0 : velocity_um_s,
                                   (int32_t)((int64_t)follower->yaw_rate_scale_urad_s * wanted / 127)};
  return command;
}
