// SPDX-License-Identifier: Apache-2.0
// Steers through a gate with the outputs of the sight network. The drone turns and climbs towards the middle of the
// opening until the frame leaves the picture. Then it keeps heading and altitude for the greatest possible distance of
// the gate plus half a metre, because no signal reports the crossing. If no gate is in view, the drone turns until a
// gate is in view.
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
  int32_t altitude_um;      // above the ground
} traverser_command_t;

// State of the drone when a picture was taken.
typedef struct {
  int32_t forward_velocity_um_s;
  int32_t altitude_um;  // measured
  int32_t elapsed_us;   // time since the previous picture
  int32_t yaw_urad;     // heading; not limited to one turn
} traverser_state_t;

// During an approach, the gate's size is stored each TRAVERSER_MARK_UM of flown distance [um]. The last TRAVERSER_MARKS
// sizes are kept.
#define TRAVERSER_MARKS 3
#define TRAVERSER_MARK_UM 250000

// Maximum number of stored headings that led to no gate.
#define TRAVERSER_DEAD_ENDS 6

typedef enum {
  TRAVERSER_SEARCH,  // hover and turn until a gate is seen
  TRAVERSER_APPROACH,
  TRAVERSER_THROUGH,    // fly straight through the gate
  TRAVERSER_ELSEWHERE,  // fly straight, backwards or forwards, to where the next search starts
  TRAVERSER_DONE        // the last gate is crossed
} traverser_phase_t;

// traverser_init() sets all fields. The caller may only read `phase`.
typedef struct {
  traverser_phase_t phase;
  policy_t policy;
  int32_t yaw_rate_scale_urad_s;
  int32_t start_altitude_um;  // altitude of the mission
  int32_t altitude_um;        // altitude of the gate's middle
  int32_t size_q8;            // mean of the last sizes, in 127ths of SIGHT_MOST_SIZE
  int32_t most_q8;            // greatest value of size_q8 in this approach, after the first marks
  int32_t most_at_um;         // flown distance when size_q8 was most_q8
  bool came_nearer;           // at most_at_um, the distance to the gate had decreased as expected
  int32_t evidence;           // evidence for a gate: integral of `visible` in 127ths over time [ms]
  int32_t unseen_us;          // time since the last picture with a gate
  int32_t stalled_us;         // time since the drone last followed its command
  // Distance to fly straight, after the frame has left the picture or a search has ended; negative = backwards.
  int32_t left_um;
  int32_t ordered_um_s;                         // velocity of the last command
  int32_t flown_um;                             // distance flown forwards since the last search
  int32_t way_urad;                             // heading at the last mark, because an object may turn the drone later
  int32_t marks;                                // marks passed since the last search
  int32_t marked_q8[TRAVERSER_MARKS];           // sizes at the last marks, latest first
  int32_t dead_ends_urad[TRAVERSER_DEAD_ENDS];  // headings that led to an object
  int dead_ends;
  int kept_dead_ends;   // number of headings kept until the next gate, because they lead back through the previous gate
  int32_t turned_urad;  // angle turned in this search; positive = left
  int32_t yaw_urad;     // heading at the last picture
  int gates;            // gates left to fly through
  int8_t last_yaw;      // last yaw output in an approach; its sign is the direction of the gate
} traverser_t;

// Starts in TRAVERSER_SEARCH at the heading `yaw_urad` with a copy of the policy. `yaw_rate_scale_urad_s` is the yaw
// rate at output 127. `gates` is the number of gates to fly through.
void traverser_init(traverser_t* traverser, const policy_t* policy, int32_t yaw_rate_scale_urad_s, int32_t altitude_um,
                    int32_t yaw_urad, int gates);

// Processes the network's outputs for one picture, and returns the next command.
traverser_command_t traverser_step(traverser_t* traverser, const sight_t* sight, const traverser_state_t* state);

#ifdef __cplusplus
}
#endif
