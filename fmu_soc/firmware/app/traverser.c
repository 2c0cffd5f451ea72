// SPDX-License-Identifier: Apache-2.0
#include "app/traverser.h"

#include "app/calibration.h"

// The evidence for a gate is the integral of `visible` - 32 over time [ms]. A clear gate (127) starts an approach
// within 0.11 s, and a gate with the value 64 within 0.31 s. A value below 32 never starts an approach. In pictures
// without a gate, a tenth of the values is above 32. Without a gate, all evidence is lost in 1.25 s.
#define DOUBTFUL 32
#define LEAST_SIGN (-16)
#define EVIDENCE_TO_APPROACH 10000
#define MOST_EVIDENCE 20000
// If a near gate with enough evidence is not visible for this time, the drone has entered it.
#define ENTERED_US 200000
#define EVIDENCE_TO_ENTER 6500
// If the drone flies slower than a quarter of its command for this time, an object has stopped it. The object was not a
// gate.
#define STALLED_US 2000000
// If the flight back from an object stalls for this time, the drone searches again where it is.
#define STUCK_US 6000000
// Sizes in 127ths of SIGHT_MOST_SIZE. At size 1.2, the frame has left the picture. If a gate of at least size 0.65 is
// no longer visible, it can only have left the picture.
#define ENTERED_SIZE 76
#define NEAR_SIZE 41
// The distance to a real gate decreases by the flown distance. The distance that is computed from a gate's size assumes
// a frame of 0.6 m and the longest focal length. With a shorter focal length or a smaller frame, it decreases faster;
// with a larger frame, it decreases slower. If the computed distance decreases by less than four fifths of the flown
// distance, the object is not a gate, or the frame is too large: more than 0.75 m with the longest lens, or more than
// 1.6 m with a lens of 87 degrees.
#define LEAST_NEARER_PERCENT 80
// Focal length divided by half the picture's width, in thousandths, for the longest lens with which the network was
// trained (0.82 rad). Of all lenses, the longest gives the greatest distance for a size in the picture.
#define LONGEST_FOCAL_MILLI 2301
// Time constant with which the drone's altitude approaches that of a gate, and greatest difference from the mission's
// altitude. Sizes below LEAST_SIZE (0.13, a gate at 5 m with a lens of 50 degrees) count as LEAST_SIZE, to limit the
// quotient.
#define ALTITUDE_US 400000
#define MOST_CLIMB_UM 700000
#define LEAST_ALTITUDE_UM 250000
#define LEAST_SIZE 8
// Yaw rate of a search, in 127ths of the mission's yaw rate scale.
#define SEARCH_YAW 64
// A search ignores gates within this angle on both sides of a heading that led to an object. HALF_VIEW_URAD is half the
// view of the longest lens, from which the heading of a gate is computed.
#define DEAD_END_URAD 450000
#define HALF_VIEW_URAD 410000
#define HALF_TURN_URAD 3141593
// If a full turn finds no gate, the drone flies this distance in a free direction. Then it searches again, and ignores
// only gates at the heading back through the last gate.
#define ELSEWHERE_UM 1000000

static int32_t limited(int32_t value, int32_t low, int32_t high) {
  return value < low ? low : value > high ? high : value;
}

// Returns the equivalent angle between -HALF_TURN_URAD and HALF_TURN_URAD.
static int32_t turned(int32_t angle_urad) {
  while (angle_urad > HALF_TURN_URAD) {
    angle_urad -= 2 * HALF_TURN_URAD;
  }
  while (angle_urad < -HALF_TURN_URAD) {
    angle_urad += 2 * HALF_TURN_URAD;
  }
  return angle_urad;
}

static void forget_most(traverser_t* t) {
  t->most_q8 = 0;
  t->came_nearer = false;
}

static void begin_way(traverser_t* t) {
  t->flown_um = 0;
  t->way_urad = t->yaw_urad;
  t->marks = 0;
  forget_most(t);
}

void traverser_init(traverser_t* t, const policy_t* policy, int32_t yaw_rate_scale_urad_s, int32_t altitude_um,
                    int32_t yaw_urad, int gates) {
  t->phase = TRAVERSER_SEARCH;
  t->policy = *policy;
  t->yaw_rate_scale_urad_s = yaw_rate_scale_urad_s;
  t->start_altitude_um = altitude_um;
  t->altitude_um = altitude_um;
  t->size_q8 = 0;
  t->evidence = 0;
  t->unseen_us = 0;
  t->stalled_us = 0;
  t->left_um = 0;
  t->ordered_um_s = 0;
  t->yaw_urad = yaw_urad;
  begin_way(t);
  t->dead_ends = 0;
  t->kept_dead_ends = 0;
  t->turned_urad = 0;
  t->gates = gates;
  t->last_yaw = 1;  // the first search turns to the left
}

static traverser_command_t command(const traverser_t* t, int32_t velocity_um_s, int yaw) {
  const traverser_command_t order = {velocity_um_s, (int32_t)((int64_t)t->yaw_rate_scale_urad_s * yaw / 127),
                                     t->altitude_um};
  return order;
}

// Moves the altitude towards that of the gate's middle. Half the frame's edge divided by its size in the picture is
// half the picture's width at the gate's distance, for any lens.
static void follow_altitude(traverser_t* t, const sight_t* sight, const traverser_state_t* state) {
  const int32_t size = sight->size < LEAST_SIZE ? LEAST_SIZE : sight->size;
  const int32_t half_frame_um = GATE_OUTER_MM * 1000 / 2;
  const int32_t above_um = (int32_t)((int64_t)half_frame_um * sight->rise / (SIGHT_MOST_SIZE * size));
  const int32_t wanted_um = limited(state->altitude_um + above_um, t->start_altitude_um - MOST_CLIMB_UM,
                                    t->start_altitude_um + MOST_CLIMB_UM);
  const int32_t elapsed_us = limited(state->elapsed_us, 0, ALTITUDE_US);
  t->altitude_um += (int32_t)((int64_t)(wanted_um - t->altitude_um) * elapsed_us / ALTITUDE_US);
  if (t->altitude_um < LEAST_ALTITUDE_UM) {
    t->altitude_um = LEAST_ALTITUDE_UM;
  }
}

static traverser_command_t straight_on(traverser_t* t) {
  return command(t, policy_speed_um_s(&t->policy, 0), 0);
}

// Returns the greatest possible distance of a gate from its size in the picture: focal length * outer edge / size, with
// the longest focal length of a camera.
static int32_t farthest_um(int32_t size_q8) {
  const int64_t divisor_q8 = size_q8 < LEAST_SIZE * 256 ? LEAST_SIZE * 256 : size_q8;
  return (int32_t)((int64_t)GATE_OUTER_MM * LONGEST_FOCAL_MILLI * 127 * 256 / (2 * SIGHT_MOST_SIZE * divisor_q8));
}

// Starts the flight through the gate, whose frame has left the picture. From then on, only the flown distance is used.
static traverser_command_t enter(traverser_t* t) {
  t->phase = TRAVERSER_THROUGH;
  t->left_um = farthest_um(t->most_q8) + PILOT_BEHIND_MM * 1000;
  return straight_on(t);
}

static traverser_command_t turn_on(const traverser_t* t) {
  return command(t, 0, t->last_yaw < 0 ? -SEARCH_YAW : SEARCH_YAW);
}

static traverser_command_t search_again(traverser_t* t) {
  t->phase = TRAVERSER_SEARCH;
  t->evidence = 0;
  t->stalled_us = 0;
  t->turned_urad = 0;
  return turn_on(t);
}

// Stores a heading. If the list is full, first removes the oldest heading that need not be kept.
static void remember_dead_end(traverser_t* t, int32_t yaw_urad) {
  if (t->dead_ends == TRAVERSER_DEAD_ENDS) {
    for (int i = t->kept_dead_ends + 1; i < TRAVERSER_DEAD_ENDS; ++i) {
      t->dead_ends_urad[i - 1] = t->dead_ends_urad[i];
    }
    --t->dead_ends;
  }
  t->dead_ends_urad[t->dead_ends++] = turned(yaw_urad);
}

static bool is_dead_end(const traverser_t* t, int32_t heading_urad) {
  for (int i = 0; i < t->dead_ends; ++i) {
    const int32_t off_urad = turned(heading_urad - t->dead_ends_urad[i]);
    if (off_urad < DEAD_END_URAD && off_urad > -DEAD_END_URAD) {
      return true;
    }
  }
  return false;
}

static traverser_command_t go_elsewhere(traverser_t* t, int32_t ahead_um) {
  t->phase = TRAVERSER_ELSEWHERE;
  t->left_um = ahead_um;
  t->stalled_us = 0;
  return command(t, ahead_um < 0 ? -t->policy.cruise_um_s : t->policy.cruise_um_s, 0);
}

static traverser_command_t search(traverser_t* t, const sight_t* sight, bool sighted) {
  if (sighted && t->evidence >= EVIDENCE_TO_APPROACH) {
    t->phase = TRAVERSER_APPROACH;
    begin_way(t);
    // After a single picture, a gate does not count as near.
    t->size_q8 = limited(sight->size, LEAST_SIZE, NEAR_SIZE - 1) * 256;
    return command(t, 0, sight->yaw);
  }
  const bool once_around = t->turned_urad > 2 * HALF_TURN_URAD || t->turned_urad < -2 * HALF_TURN_URAD;
  if (once_around && !is_dead_end(t, t->yaw_urad)) {
    t->dead_ends = t->kept_dead_ends;
    return go_elsewhere(t, ELSEWHERE_UM);
  }
  return turn_on(t);
}

// Returns velocity times time in whole micrometres. The time must be at most some seconds.
static int32_t flown_um(const traverser_state_t* state) {
  return (int32_t)((int64_t)state->forward_velocity_um_s * state->elapsed_us / 1000000);
}

static void fly_on(traverser_t* t, const traverser_state_t* state) {
  t->flown_um += flown_um(state);
  if (t->flown_um >= (t->marks + 1) * TRAVERSER_MARK_UM) {
    ++t->marks;
    for (int i = TRAVERSER_MARKS - 1; i > 0; --i) {
      t->marked_q8[i] = t->marked_q8[i - 1];
    }
    t->marked_q8[0] = t->size_q8;
    t->way_urad = t->yaw_urad;
  }
}

// Ends an approach that found no gate. The drone flies back by the distance of the approach, and then searches again.
static traverser_command_t leave(traverser_t* t) {
  remember_dead_end(t, t->way_urad);
  return t->flown_um > 0 ? go_elsewhere(t, -t->flown_um) : search_again(t);
}

// Updates the mean size. A gate grows by some hundredths per picture. Therefore a size above 1.5 times the mean counts
// as 1.5 times the mean. If the flight through the gate nevertheless starts too early, the drone still crosses the
// gate, because it flies an additional half metre.
//
// The true size only grows, but the measured size decreases while the frame leaves the picture. Therefore the greatest
// mean is stored.
static void follow_size(traverser_t* t, const sight_t* sight) {
  t->size_q8 += (limited(sight->size * 256, LEAST_SIZE * 256, t->size_q8 * 3 / 2) - t->size_q8) / 4;
  if (t->marks >= TRAVERSER_MARKS && t->size_q8 > t->most_q8) {
    t->most_q8 = t->size_q8;
    t->most_at_um = t->flown_um;
    const int32_t nearer_um = farthest_um(t->marked_q8[TRAVERSER_MARKS - 1]) - farthest_um(t->most_q8);
    const int32_t since_um = t->flown_um - (t->marks - TRAVERSER_MARKS + 1) * TRAVERSER_MARK_UM;
    t->came_nearer = 100 * nearer_um >= LEAST_NEARER_PERCENT * since_um;
  }
}

// Returns true if the drone must have passed the gate: since the gate's size was largest, it has flown farther than the
// greatest distance at which a gate has this size. Then there was no gate, or the drone has crossed it unnoticed.
static bool most_is_behind(const traverser_t* t) {
  return t->flown_um - t->most_at_um > farthest_um(t->most_q8);
}

static traverser_command_t approach(traverser_t* t, const sight_t* sight, bool sighted,
                                    const traverser_state_t* state) {
  if (t->most_q8 > 0 && most_is_behind(t)) {
    forget_most(t);
  }
  const bool near = t->most_q8 >= NEAR_SIZE * 256;
  const bool left = t->unseen_us > ENTERED_US && t->evidence >= EVIDENCE_TO_ENTER;
  if (t->most_q8 >= ENTERED_SIZE * 256 || (near && left)) {
    return t->came_nearer ? enter(t) : leave(t);
  }
  if (t->evidence == 0) {
    return search_again(t);
  }
  if (sighted) {
    if (sight->yaw != 0) {
      t->last_yaw = sight->yaw;
    }
    follow_size(t, sight);
    follow_altitude(t, sight, state);
    return command(t, policy_speed_um_s(&t->policy, sight->yaw), sight->yaw);
  }
  return straight_on(t);
}

static traverser_command_t through(traverser_t* t, const traverser_state_t* state) {
  t->left_um -= flown_um(state);
  if (t->left_um > 0) {
    return straight_on(t);
  }
  if (--t->gates > 0) {
    // The drone must not fly back through this gate.
    t->dead_ends = t->kept_dead_ends = 0;
    remember_dead_end(t, t->yaw_urad + HALF_TURN_URAD);
    t->kept_dead_ends = 1;
    return search_again(t);
  }
  t->phase = TRAVERSER_DONE;
  return command(t, 0, 0);
}

static traverser_command_t elsewhere(traverser_t* t, const traverser_state_t* state) {
  const bool back = t->left_um < 0;
  t->left_um -= flown_um(state);
  const bool there = back ? t->left_um >= 0 : t->left_um <= 0;
  if (!back && t->stalled_us > STALLED_US) {
    remember_dead_end(t, t->yaw_urad);
    return search_again(t);
  }
  if (there || t->stalled_us > STUCK_US) {
    return search_again(t);
  }
  return command(t, back ? -t->policy.cruise_um_s : t->policy.cruise_um_s, 0);
}

static void weigh(traverser_t* t, const sight_t* sight, int32_t elapsed_us) {
  const int32_t heading_urad = t->yaw_urad + HALF_VIEW_URAD / 127 * sight->yaw;
  const bool dead_end = t->phase == TRAVERSER_SEARCH && is_dead_end(t, heading_urad);
  const int32_t sign = dead_end ? LEAST_SIGN : limited(sight->visible - DOUBTFUL, LEAST_SIGN, 127);
  const int32_t elapsed_ms = limited(elapsed_us, 0, 1000000) / 1000;
  t->evidence = limited(t->evidence + sign * elapsed_ms, 0, MOST_EVIDENCE);
  t->unseen_us = sight->visible > 0 ? 0 : limited(t->unseen_us, 0, ENTERED_US) + elapsed_us;
}

static traverser_command_t next(traverser_t* t, const sight_t* sight, const traverser_state_t* state) {
  const bool sighted = sight->visible > 0;
  switch (t->phase) {
    case TRAVERSER_SEARCH:
      return search(t, sight, sighted);
    case TRAVERSER_APPROACH:
      fly_on(t, state);
      return t->stalled_us > STALLED_US ? leave(t) : approach(t, sight, sighted, state);
    case TRAVERSER_THROUGH:
      fly_on(t, state);
      // An object has stopped the drone: a wall near a crossed gate, or a wall with the picture of a gate. The drone
      // cannot distinguish them, so it flies back.
      return t->stalled_us > STALLED_US ? leave(t) : through(t, state);
    case TRAVERSER_ELSEWHERE:
      return elsewhere(t, state);
    case TRAVERSER_DONE:
      break;
  }
  return command(t, 0, 0);
}

traverser_command_t traverser_step(traverser_t* t, const sight_t* sight, const traverser_state_t* state) {
  t->turned_urad += turned(state->yaw_urad - t->yaw_urad);
  t->yaw_urad = state->yaw_urad;
  weigh(t, sight, state->elapsed_us);
  const int32_t along_um_s = t->ordered_um_s < 0 ? -state->forward_velocity_um_s : state->forward_velocity_um_s;
  const int32_t ordered_um_s = t->ordered_um_s < 0 ? -t->ordered_um_s : t->ordered_um_s;
  const bool slow = ordered_um_s > 0 && along_um_s < ordered_um_s / 4;
  t->stalled_us = slow ? limited(t->stalled_us, 0, STUCK_US) + state->elapsed_us : 0;
  const traverser_command_t order = next(t, sight, state);
  t->ordered_um_s = order.velocity_um_s;
  return order;
}
