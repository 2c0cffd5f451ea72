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
  int32_t yaw_urad;     // heading; may go around
} traverser_state_t;

// Sizes that are remembered, one each so far apart.
#define TRAVERSER_MARKS 3
#define TRAVERSER_MARK_UM 250000

// How many headings that led to no gate are remembered.
#define TRAVERSER_DEAD_ENDS 6

typedef enum {
  TRAVERSER_SEARCH,     // hover and turn until a gate is seen
  TRAVERSER_APPROACH,   // fly to where the gate is
  TRAVERSER_THROUGH,    // straight on through it
  TRAVERSER_ELSEWHERE,  // straight to where to search next, back or on
  TRAVERSER_DONE        // behind the last gate
} traverser_phase_t;

// Set by traverser_init; `phase` may be read.
typedef struct {
  traverser_phase_t phase;
  policy_t policy;
  int32_t yaw_rate_scale_urad_s;
  int32_t start_altitude_um;  // that the mission asks for
  int32_t altitude_um;        // where the gate's middle is
  int32_t size_q8;            // mean of the last sizes, in 127ths of SIGHT_MOST_SIZE
  int32_t most_q8;            // the greatest such mean of this approach, after the first marks
  int32_t most_at_um;         // flown then
  bool came_nearer;           // whether what is flown to had then come nearer as a gate does
  int32_t evidence;           // that there is a gate: 127ths of `visible` times ms
  int32_t unseen_us;          // since a gate was in the picture
  int32_t stalled_us;         // since the drone flew as it was commanded to
  int32_t left_um;            // to fly straight, since the frame left the picture or the search ended; negative: back
  int32_t ordered_um_s;       // the last command's velocity
  int32_t flown_um;           // forwards, since the last search
  int32_t way_urad;           // heading at the last mark, before anything that it leans against turns the drone
  int32_t marks;              // passed on that way
  int32_t marked_q8[TRAVERSER_MARKS];           // sizes at the last of them, the latest first
  int32_t dead_ends_urad[TRAVERSER_DEAD_ENDS];  // headings that led against something
  int dead_ends;
  int kept_dead_ends;   // the first of them are kept: the one back through the gate before
  int32_t turned_urad;  // by this search; left is positive
  int32_t yaw_urad;     // at the last picture
  int gates;            // to fly through, from here on
  int8_t last_yaw;      // where the gate of the last approach was
} traverser_t;

// Starts in TRAVERSER_SEARCH at the heading `yaw_urad` with the policy as it is. The scale is the yaw rate at output
// 127.
void traverser_init(traverser_t* traverser, const policy_t* policy, int32_t yaw_rate_scale_urad_s, int32_t altitude_um,
                    int32_t yaw_urad, int gates);

// One picture.
traverser_command_t traverser_step(traverser_t* traverser, const sight_t* sight, const traverser_state_t* state);

#ifdef __cplusplus
}
#endif
