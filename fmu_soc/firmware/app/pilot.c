// SPDX-License-Identifier: Apache-2.0
#include "app/pilot.h"

// Minimum confidence of a picture with a gate.
#define LEAST_CONFIDENCE 64
// Number of consecutive pictures with a gate before an approach, and without a gate before a new search.
#define SIGHTINGS_TO_APPROACH 3
#define MISSES_TO_SEARCH 20
// Below this distance, a gate that is no longer seen has left the view. The approach then continues with the state
// estimate.
#define BLIND_APPROACH_UM 900000
// Number of consecutive distances that must contradict the estimate before they replace it.
#define OUTLIERS_TO_BELIEVE 5
// Yaw rate of a search, in 127ths of the mission's yaw rate scale.
#define SEARCH_YAW 38  // 0.3 of the scale

static int32_t abs_i32(int32_t a) {
  return a < 0 ? -a : a;
}

void pilot_init(pilot_t* pilot, const policy_t* policy, int32_t yaw_rate_scale_urad_s) {
  pilot->phase = PILOT_SEARCH;
  pilot->remaining_um = 0;
  pilot->policy = *policy;
  pilot->yaw_rate_scale_urad_s = yaw_rate_scale_urad_s;
  pilot->last_velocity_um_s = 0;
  pilot->sightings = 0;
  pilot->misses = 0;
  pilot->outliers = 0;
  pilot->last_yaw = 1;  // before the first picture with a gate, a search turns to the left
}

// Returns the distance flown since the last picture [um], from the mean of the two velocities.
static int32_t flown_um(pilot_t* pilot, int32_t velocity_um_s, int32_t elapsed_us) {
  const int64_t twice = (int64_t)velocity_um_s + pilot->last_velocity_um_s;
  pilot->last_velocity_um_s = velocity_um_s;
  return (int32_t)(twice * elapsed_us / 2000000);
}

// Moves the estimate by a quarter of the difference to a measured distance, unless the two contradict each other.
static void correct_remaining(pilot_t* pilot, uint16_t distance_mm) {
  if (distance_mm == 0) {
    return;
  }
  const int32_t measured_um = (int32_t)distance_mm * 1000;
  const int32_t difference_um = measured_um - pilot->remaining_um;
  const int32_t limit_um = 100000 + pilot->remaining_um / 4;
  if (abs_i32(difference_um) <= limit_um) {
    pilot->remaining_um += difference_um / 4;
    pilot->outliers = 0;
  } else if (++pilot->outliers >= OUTLIERS_TO_BELIEVE) {
    pilot->remaining_um = measured_um;
    pilot->outliers = 0;
  }
}

static pilot_command_t turn_and_fly(const pilot_t* pilot, int32_t velocity_um_s, int yaw) {
  const pilot_command_t command = {velocity_um_s, (int32_t)((int64_t)pilot->yaw_rate_scale_urad_s * yaw / 127)};
  return command;
}

static pilot_command_t search(pilot_t* pilot, const navigator_output_t* seen, bool sighted) {
  if (sighted && pilot->sightings >= SIGHTINGS_TO_APPROACH) {
    pilot->phase = PILOT_APPROACH;
    pilot->remaining_um = (int32_t)seen->distance_mm * 1000;
    pilot->outliers = 0;
    return turn_and_fly(pilot, policy_speed_um_s(&pilot->policy, seen->yaw), seen->yaw);
  }
  if (sighted) {
    return turn_and_fly(pilot, 0, 0);  // hovers and uses the next picture
  }
  return turn_and_fly(pilot, 0, pilot->last_yaw < 0 ? -SEARCH_YAW : SEARCH_YAW);
}

static pilot_command_t straight_on(pilot_t* pilot) {
  return turn_and_fly(pilot, policy_speed_um_s(&pilot->policy, 0), 0);
}

static pilot_command_t approach(pilot_t* pilot, const navigator_output_t* seen, bool sighted) {
  if (sighted) {
    correct_remaining(pilot, seen->distance_mm);
  }
  if (pilot->remaining_um <= PILOT_COMMIT_MM * 1000) {
    pilot->phase = PILOT_THROUGH;
    return straight_on(pilot);
  }
  if (sighted) {
    return turn_and_fly(pilot, policy_speed_um_s(&pilot->policy, seen->yaw), seen->yaw);
  }
  if (pilot->remaining_um > BLIND_APPROACH_UM && pilot->misses >= MISSES_TO_SEARCH) {
    pilot->phase = PILOT_SEARCH;
    return search(pilot, seen, false);
  }
  return straight_on(pilot);
}

pilot_command_t pilot_step(pilot_t* pilot, const navigator_output_t* seen, int32_t forward_velocity_um_s,
                           int32_t elapsed_us) {
  const bool sighted = seen->confidence >= LEAST_CONFIDENCE;
  pilot->sightings = sighted ? pilot->sightings + 1 : 0;
  pilot->misses = sighted ? 0 : pilot->misses + 1;
  if (sighted && seen->yaw != 0) {
    pilot->last_yaw = seen->yaw;
  }
  pilot->remaining_um -= flown_um(pilot, forward_velocity_um_s, elapsed_us);

  switch (pilot->phase) {
    case PILOT_SEARCH:
      return search(pilot, seen, sighted);
    case PILOT_APPROACH:
      return approach(pilot, seen, sighted);
    case PILOT_THROUGH:
      if (pilot->remaining_um > -PILOT_BEHIND_MM * 1000) {
        return straight_on(pilot);
      }
      pilot->phase = PILOT_DONE;
      break;
    case PILOT_DONE:
      break;
  }
  return turn_and_fly(pilot, 0, 0);
}
