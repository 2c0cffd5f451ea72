// SPDX-License-Identifier: Apache-2.0
// Controls the clock and the sleep of the fabric controller, and the end of its program, on boards with MEbots' power
// manager.
#pragma once

#include <stdint.h>

#include "board.h"

#ifdef __cplusplus
extern "C" {
#endif

static inline uint32_t core_clock_hz(void) {
  return POWER_MANAGER_CLOCK_HZ;
}
static inline void core_clock_set(uint32_t hz) {
  POWER_MANAGER_CLOCK_HZ = hz;
}

// Enables interrupt `number`. An enabled interrupt ends a sleep and, if interrupts are on, calls its handler.
static inline void core_enable_interrupt(unsigned number) {
  const uint32_t bit = UINT32_C(1) << number;
  __asm__ volatile("csrs mie, %0" ::"r"(bit) : "memory");
}

// Sleeps until an enabled interrupt is pending. Interrupts may be off.
static inline void core_sleep(void) {
  __asm__ volatile("wfi" ::: "memory");
}

static inline void core_end(int code) {
  POWER_MANAGER_EXIT = (uint32_t)code;
}

#ifdef __cplusplus
}
#endif
