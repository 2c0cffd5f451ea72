// SPDX-License-Identifier: Apache-2.0
// Sets the PWM outputs to the motors.
#pragma once

#include <stdint.h>

#include "board.h"

// Ticks in a period, as on a Crazyflie with brushed motors: 8 bits at 328 kHz.
#define ROTOR_TICKS 256

static inline void rotors_init(void) {
  ROTORS_PERIOD = ROTOR_TICKS;
}

static inline uint32_t rotor_ticks(float share) {
  const float limited = share >= 1.0F ? 1.0F : share > 0.0F ? share : 0.0F;  // NaN becomes 0
  return (uint32_t)(limited * (float)ROTOR_TICKS + 0.5F);
}

static inline void rotors_set(const float share[4]) {
  ROTORS_DUTY_1 = rotor_ticks(share[0]);
  ROTORS_DUTY_2 = rotor_ticks(share[1]);
  ROTORS_DUTY_3 = rotor_ticks(share[2]);
  ROTORS_DUTY_4 = rotor_ticks(share[3]);
  ROTORS_CONTROL = 1;
}

static inline void rotors_off(void) {
  ROTORS_CONTROL = 0;
}
