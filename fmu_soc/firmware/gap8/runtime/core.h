// SPDX-License-Identifier: Apache-2.0
// The fabric controller's clock, sleep and end, which differ between chips. This file is for GAP8's frequency-locked
// loops, event unit and SoC control.
#pragma once

#include <stdint.h>

#include "runtime/event_load.h"
#include "runtime/registers.h"

#ifdef __cplusplus
extern "C" {
#endif

// Returns the present clock [Hz].
uint32_t core_clock_hz(void);
// Sets the loop to the nearest possible frequency. While a peripheral sends at a bit rate that comes from this clock, a
// lower frequency is ignored. The interrupt at the end of the transfer wakes the core. The end of the last byte raises
// no interrupt, so the clock stays unchanged until the next sleep.
void core_clock_set(uint32_t hz);

// Enables interrupt `number`. An enabled interrupt ends a sleep, and is taken if interrupts are on.
static inline void core_enable_interrupt(unsigned number) {
  const uint32_t bit = UINT32_C(1) << number;
  store(EU_BASE + EU_MASK_OR_OFFSET, bit);
  store(EU_BASE + EU_MASK_IRQ_OR_OFFSET, bit);
}

// Sleeps until an enabled interrupt is pending, also with interrupts off.
static inline void core_sleep(void) {
  event_load(EU_BASE + EU_WAIT_OFFSET);
}

// Sleeps until event `event` of the fabric controller is pending, and clears this event. Other events stay pending.
static inline void core_sleep_until(unsigned event) {
  const uint32_t mask = load(EU_BASE + EU_MASK_OFFSET);
  store(EU_BASE + EU_MASK_OFFSET, UINT32_C(1) << event);
  event_load(EU_BASE + EU_WAIT_CLEAR_OFFSET);
  store(EU_BASE + EU_MASK_OFFSET, mask);
}

// Ends the program.
void core_end(int code);

#ifdef __cplusplus
}
#endif
