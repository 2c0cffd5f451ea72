// SPDX-License-Identifier: Apache-2.0
// Computes set-points from the navigator's output. The drone searches for the gate, flies to it and through it. The
// pilot uses only the pictures and the state estimate: from the estimated distance, it computes when the gate is
// crossed.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "app/navigator.h"
#include "app/policy.h"

#ifdef __cplusplus
extern "C" {
#endif

// Below this distance, the frame fills the view or is outside it. The drone then flies straight, with the state
// estimate only.
#define PILOT_COMMIT_MM 450
// The pilot stops the drone at this distance after the gate's plane.
#define PILOT_BEHIND_MM 500

typedef enum {
  PILOT_SEARCH,    // hover and turn until a gate is seen
  PILOT_APPROACH,  // fly in the direction of the navigator's output
  PILOT_THROUGH,   // fly straight through the gate
  PILOT_DONE
} pilot_phase_t;

typedef struct {
  int32_t velocity_um_s;    // forward
  int32_t yaw_rate_urad_s;  // positive = left
} pilot_command_t;

// pilot_init() sets all fields. The caller may only read `phase` and `remaining_um`.
typedef struct {
  pilot_phase_t phase;
  int32_t remaining_um;  // estimated distance to the gate's plane; negative = after the plane
  policy_t policy;
  int32_t yaw_rate_scale_urad_s;
  int32_t last_velocity_um_s;
  int sightings;  // consecutive pictures with a gate
  int misses;     // consecutive pictures without a gate
  int outliers;   // consecutive distances that contradict the estimate
  int8_t last_yaw;
} pilot_t;

// Starts in PILOT_SEARCH with a copy of the policy. `yaw_rate_scale_urad_s` is the yaw rate at navigator output 127.
void pilot_init(pilot_t* pilot, const policy_t* policy, int32_t yaw_rate_scale_urad_s);

// Processes one picture. `seen` is the navigator's output. `elapsed_us` is the time since the last call.
pilot_command_t pilot_step(pilot_t* pilot, const navigator_output_t* seen, int32_t forward_velocity_um_s,
                           int32_t elapsed_us);

#ifdef __cplusplus
}
#endif
