// SPDX-License-Identifier: Apache-2.0
// From what the navigator sees to set-points: search the gate, fly to it, fly through it, all by vision and by the
// state estimate. Nobody tells the pilot when the drone has passed the gate: it follows the distance that is left.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "app/navigator.h"
#include "app/policy.h"

#ifdef __cplusplus
extern "C" {
#endif

// From here on the frame fills or leaves the view: fly straight on, by the state estimate alone.
#define PILOT_COMMIT_MM 450
// How far behind the gate's plane the pilot is done.
#define PILOT_BEHIND_MM 500

typedef enum {
  PILOT_SEARCH,    // hover and turn until a gate is seen
  PILOT_APPROACH,  // fly to where the navigator points
  PILOT_THROUGH,   // straight on through the gate
  PILOT_DONE       // behind the gate
} pilot_phase_t;

typedef struct {
  int32_t velocity_um_s;    // forward
  int32_t yaw_rate_urad_s;  // positive = left
} pilot_command_t;

// Set by pilot_init; `phase` and `remaining_um` may be read.
typedef struct {
  pilot_phase_t phase;
  int32_t remaining_um;  // estimated distance to the gate's plane; negative behind it
  policy_t policy;
  int32_t yaw_rate_scale_urad_s;
  int32_t last_velocity_um_s;
  int sightings;  // pictures with a gate in a row
  int misses;     // pictures without one in a row
  int outliers;   // distances in a row that do not fit the estimate
  int8_t last_yaw;
} pilot_t;

// Starts in PILOT_SEARCH with the policy as it is. The scale is the yaw rate at navigator output 127.
void pilot_init(pilot_t* pilot, const policy_t* policy, int32_t yaw_rate_scale_urad_s);

// One picture: what the navigator saw in it, the velocity along the heading now, and the time since the last call.
pilot_command_t pilot_step(pilot_t* pilot, const navigator_output_t* seen, int32_t forward_velocity_um_s,
                           int32_t elapsed_us);

#ifdef __cplusplus
}
#endif
