// SPDX-License-Identifier: Apache-2.0
// Steers through a gate by what the sight network tells: turns and climbs towards the middle of its opening up to where
// the frame leaves the picture, then holds heading and altitude. Turns until it sees a gate that was never seen, or
// that got lost. Nobody tells it when the drone has passed the gate: it flies on as far as the gate can be, and half a
// metre more.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "app/pilot.h"
#include "app/policy.h"
#include "app/sight.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
  int32_t velocity_um_s;    // forward
  int32_t yaw_rate_urad_s;  // positive = left
  int32_t altitude_um;      // above ground
} traverser_command_t;

// What the drone knows of itself at a picture.
typedef struct {
  int32_t forward_velocity_um_s;
  int32_t altitude_um;  // measured
  int32_t elapsed_us;   // since the picture before
} traverser_state_t;

// Set by traverser_init; `phase` may be read.
typedef struct {
  pilot_phase_t phase;
  policy_t policy;
  int32_t yaw_rate_scale_urad_s;
  int32_t start_altitude_um;  // that the mission asks for
  int32_t altitude_um;        // where the gate's middle is
  int32_t size_q8;            // mean of the last sizes, in 127ths of SIGHT_MOST_SIZE
  int32_t evidence;           // that there is a gate: 127ths of `visible` times ms
  int32_t unseen_us;          // since a gate was in the picture
  int32_t stalled_us;         // since the drone flew as it was commanded to
  int32_t left_um;            // to fly straight on, since the frame left the picture
  int32_t ordered_um_s;       // the last command's velocity
  int8_t last_yaw;            // where the gate of the last approach was
} traverser_t;

// Starts in PILOT_SEARCH with the policy as it is. The scale is the yaw rate at output 127.
void traverser_init(traverser_t* traverser, const policy_t* policy, int32_t yaw_rate_scale_urad_s, int32_t altitude_um);

// One picture.
traverser_command_t traverser_step(traverser_t* traverser, const sight_t* sight, const traverser_state_t* state);

#ifdef __cplusplus
}
#endif
