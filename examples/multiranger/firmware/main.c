// SPDX-License-Identifier: Apache-2.0
// Flies to the east around the obstacles that the range sensors measure, and lands after the distance COURSE_GOAL.
#include "board.h"
#include "drivers/timer.h"
#include "runtime/console.h"

#define PERIOD_NS (50 * NS_PER_MS)  // the sensors have a new sample every 100 ms
#define ALTITUDE_UM 800000
#define CRUISE_MM_S 400
#define SIDESTEP_MM_S 300
#define BLOCKED_MM 900     // distance to an obstacle ahead at which a sidestep starts
#define STOP_MM 450        // distance to an obstacle ahead at which the forward speed is 0
#define CLEARANCE_MM 600   // distance to an obstacle at the side from which the drone moves away
#define DEAD_END_MM 450    // distance to an obstacle at the side at which a sidestep reverses or ends
#define CORNER_PERIODS 24  // of a sidestep after the way ahead is free: 0.36 m, for the drone's width

typedef struct {
  int direction;  // of the sidestep: 1 = left, -1 = right, 0 = none
  int periods;    // periods until the end of the sidestep
} avoid_t;

static int32_t limited(int32_t value, int32_t least, int32_t most) {
  return value > most ? most : value < least ? least : value;
}

static void fly(uint32_t mode, int32_t x_mm_s, int32_t y_mm_s) {
  FLIGHT_MODE = mode;
  FLIGHT_VELOCITY_X = (uint32_t)(1000 * x_mm_s);
  FLIGHT_VELOCITY_Y = (uint32_t)(1000 * y_mm_s);
  FLIGHT_YAW_RATE = 0;
  FLIGHT_ALTITUDE = ALTITUDE_UM;
  FLIGHT_COMMIT = 1;
}

// Starts a sidestep towards the side with more space, or continues it until the drone has passed the corner. If that
// side has an obstacle, reverses the sidestep, or ends it if the way ahead is free.
static void choose_side(avoid_t* avoid) {
  if (RANGER_FRONT < BLOCKED_MM) {
    if (avoid->direction == 0) {
      avoid->direction = RANGER_LEFT >= RANGER_RIGHT ? 1 : -1;
      print("obstacle at %u mm: %s\n", (unsigned)RANGER_FRONT, avoid->direction > 0 ? "left" : "right");
    }
    avoid->periods = CORNER_PERIODS;
  } else if (avoid->periods > 0 && --avoid->periods == 0) {
    avoid->direction = 0;
  }
  const uint32_t ahead_mm = avoid->direction > 0 ? RANGER_LEFT : RANGER_RIGHT;
  if (avoid->direction != 0 && ahead_mm < DEAD_END_MM) {
    if (RANGER_FRONT < BLOCKED_MM) {
      avoid->direction = -avoid->direction;
    } else {
      *avoid = (avoid_t){0, 0};
    }
  }
}

// Returns the velocity to the left that moves the drone away from obstacles at its sides.
static int32_t away_from_sides_mm_s(void) {
  int32_t velocity_mm_s = 0;
  if (RANGER_LEFT < CLEARANCE_MM) {
    velocity_mm_s -= CLEARANCE_MM - (int32_t)RANGER_LEFT;
  }
  if (RANGER_RIGHT < CLEARANCE_MM) {
    velocity_mm_s += CLEARANCE_MM - (int32_t)RANGER_RIGHT;
  }
  return limited(velocity_mm_s, -SIDESTEP_MM_S, SIDESTEP_MM_S);
}

static void fly_on(avoid_t* avoid) {
  if (COURSE_AVOID == 0) {
    fly(FLIGHT_MODE_FLY, CRUISE_MM_S, 0);
    return;
  }
  choose_side(avoid);
  if (avoid->direction != 0) {
    // At the start of a sidestep, the drone still has some forward speed. If it comes nearer than STOP_MM, it flies
    // back.
    const int32_t back_mm_s = limited((int32_t)RANGER_FRONT - STOP_MM, -SIDESTEP_MM_S, 0);
    fly(FLIGHT_MODE_FLY, back_mm_s, SIDESTEP_MM_S * avoid->direction);
  } else {
    fly(FLIGHT_MODE_FLY, limited((int32_t)RANGER_FRONT - STOP_MM, 0, CRUISE_MM_S), away_from_sides_mm_s());
  }
}

int main(void) {
  timer_init();
  int64_t time_ns = timer_now_ns();
  avoid_t avoid = {0, 0};
  bool arrived = false;
  while (FLIGHT_PHASE < FLIGHT_PHASE_LANDED) {
    arrived = arrived || (int32_t)FLIGHT_POSITION_X >= (int32_t)COURSE_GOAL;
    if (arrived) {
      fly(FLIGHT_MODE_LAND, 0, 0);
    } else if (FLIGHT_PHASE < FLIGHT_PHASE_FLYING) {
      fly(FLIGHT_MODE_TAKE_OFF, 0, 0);
    } else {
      fly_on(&avoid);
    }
    time_ns += PERIOD_NS;
    timer_sleep_until(time_ns);
  }
  return arrived ? 0 : 1;
}
