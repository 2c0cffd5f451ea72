// SPDX-License-Identifier: Apache-2.0
#include "runtime/core.h"
#include "runtime/interrupt.h"

static uint32_t sleep_clock_hz = UINT32_MAX;

void sleep_clock_set(uint32_t hz) {
  sleep_clock_hz = hz;
}

uint32_t sleep_clock_lower(void) {
  const uint32_t awake_clock_hz = core_clock_hz();
  // During a sleep, the clock tree still needs power, which is proportional to the clock.
  if (sleep_clock_hz < awake_clock_hz) {
    core_clock_set(sleep_clock_hz);
  }
  return awake_clock_hz;
}

void sleep_until_interrupt(void) {
  const uint32_t awake_clock_hz = sleep_clock_lower();
  core_sleep();
  if (sleep_clock_hz < awake_clock_hz) {
    core_clock_set(awake_clock_hz);
  }
  interrupts_on();
  interrupts_off();
}
