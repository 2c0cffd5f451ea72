// SPDX-License-Identifier: Apache-2.0
// Implements the pilot of the paper (examples/paper). The drone flies to the gate with the network's yaw and the
// policy's speed, until flight.gate_crossed reports the crossing. Then the drone flies a little farther, so that it
// does not land on the gate.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "app/pilot.h"
#include "app/policy.h"

#ifdef __cplusplus
extern "C" {
#endif

// follower_init() sets all fields. The caller may only read `phase`.
typedef struct {
  pilot_phase_t phase;  // PILOT_APPROACH, PILOT_THROUGH, PILOT_DONE
  int32_t behind_um;    // distance flown since the gate was crossed
  policy_t policy;
  int32_t yaw_rate_scale_urad_s;
} follower_t;

// Starts in PILOT_APPROACH with a copy of the policy. `yaw_rate_scale_urad_s` is the yaw rate at network output 127.
void follower_init(follower_t* follower, const policy_t* policy, int32_t yaw_rate_scale_urad_s);

// Processes one picture. `yaw` is the network's output. `crossed` must be true after the gate was crossed. `elapsed_us`
// is the time since the last call.
pilot_command_t follower_step(follower_t* follower, int8_t yaw, bool crossed, int32_t forward_velocity_um_s,
                              int32_t elapsed_us);

#ifdef __cplusplus
}
#endif
