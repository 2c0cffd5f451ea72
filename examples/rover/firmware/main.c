// SPDX-License-Identifier: Apache-2.0
// Drives straight ahead for the distance of the parameter errand.distance, and stops. Exit code 0: arrived; 2: the
// bumper was hit; 3: the wheels do not turn.
#include "board.h"
#include "drivers/timer.h"
#include "runtime/console.h"

#define PERIOD_NS (20 * NS_PER_MS)
#define STILL_PERIODS 25    // periods without motion, half a second
#define BRAKING_PERIODS 25  // periods until the wheels stop
#define STEERING_PER_S 2    // change of each rim speed per heading error, in um/s per urad over the half track

enum { THERE = 0, BUMPED = 2, STUCK = 3 };

static void drive(int32_t left_um_s, int32_t right_um_s) {
  WHEELS_SPEED_LEFT = (uint32_t)left_um_s;
  WHEELS_SPEED_RIGHT = (uint32_t)right_um_s;
  WHEELS_COMMIT = 1;
}

static int32_t way_um(void) {
  return ((int32_t)WHEELS_WAY_LEFT + (int32_t)WHEELS_WAY_RIGHT) / 2;
}

// Drives the distance. Returns the exit code.
static int go(int32_t distance_um, int32_t speed_um_s, int64_t* time_ns) {
  int32_t before_um = way_um();
  int still = 0;
  while (way_um() < distance_um) {
    if (BODY_BUMPER != 0) {
      return BUMPED;
    }
    const int32_t turn_um_s = STEERING_PER_S * (int32_t)BODY_HEADING / 10;
    drive(speed_um_s + turn_um_s, speed_um_s - turn_um_s);
    *time_ns += PERIOD_NS;
    timer_sleep_until(*time_ns);
    still = way_um() == before_um ? still + 1 : 0;
    before_um = way_um();
    if (still == STILL_PERIODS) {
      return STUCK;
    }
  }
  return THERE;
}

int main(void) {
  timer_init();
  int64_t time_ns = timer_now_ns();
  const int32_t distance_um = (int32_t)ERRAND_DISTANCE;
  print("to go %d mm at %d mm/s, %u mV\n", (int)(distance_um / 1000), (int)(ERRAND_SPEED / 1000),
        (unsigned)PACK_VOLTAGE);
  const int result = go(distance_um, (int32_t)ERRAND_SPEED, &time_ns);
  drive(0, 0);
  timer_sleep_until(time_ns + BRAKING_PERIODS * PERIOD_NS);
  print("%s after %d mm\n", result == THERE ? "there" : result == BUMPED ? "bumped" : "stuck", (int)(way_um() / 1000));
  return result;
}
