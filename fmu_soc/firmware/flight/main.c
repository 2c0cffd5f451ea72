// SPDX-License-Identifier: Apache-2.0
// Runs the flight controller. One loop takes a millisecond, the period of the IMU's samples.
#include "board.h"
#include "drivers/imu.h"
#include "drivers/rotors.h"
#include "flight/companion.h"
#include "flight/controller.h"
#include "flight/estimator.h"
#include "flight/goal.h"
#include "runtime/console.h"
#include "runtime/interrupt.h"

// Loops in which the command increases to its full size. If four motors started at full command, the supply voltage
// would fall until the cell's protection opens.
#define SOFT_START_LOOPS 200

static void soften(float command[ROTORS], unsigned loops) {
  if (loops >= SOFT_START_LOOPS) {
    return;
  }
  for (int i = 0; i < ROTORS; ++i) {
    command[i] *= (float)loops / (float)SOFT_START_LOOPS;
  }
}

int main(void) {
  interrupts_off();
  rotors_init();
  estimator_init();
  controller_init();
  imu_init(LOOP_PERIOD_MS * 1000);
  bool flew = false;
  unsigned loops = 0;  // loops since the motors were switched on
  bool is_late = false;
  for (;;) {
    imu_sample_t sample;
    if (imu_wait(&sample) != 0 && !is_late) {
      is_late = true;
      print("the loop takes more than 1 ms at %u us\n", sample.time_us);
    }
#ifdef UART_DATA
    companion_update(sample.time_us);
#endif
    estimator_update(&sample, flew);
    const flight_state_t* state = estimator_state();
    const bool flies = goal_update(state, estimator_range());
    if (flies) {
      float command[ROTORS];
      loops = flew ? loops + 1 : 0;
      controller_update(goal_now(), state, !flew, command);
      soften(command, loops);
      rotors_set(command);
    } else if (flew) {
      rotors_off();
    }
    flew = flies;
  }
}
