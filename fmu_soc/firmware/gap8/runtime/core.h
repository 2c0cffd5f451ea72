// SPDX-License-Identifier: Apache-2.0
// Controls the fabric controller's clock, sleep and end, which differ between chips. This file is for GAP8's
// frequency-locked loops, event unit and SoC control.
#pragma once

#include <stdint.h>

#include "runtime/event_load.h"
#include "runtime/registers.h"

#ifdef __cplusplus
extern "C" {
#endif

// Returns the present clock frequency [Hz].
uint32_t core_clock_hz(void);
// Sets the loop as loop_set() does (runtime/chip.h). If a peripheral is sending at a bit rate that is derived from this
// clock, ignores a lower frequency. The interrupt at the end of the transfer wakes the core. The end of the last byte
// raises no interrupt, so that the clock stays unchanged until the next sleep.
void core_clock_set(uint32_t hz);

// Enables interrupt `number`. An enabled interrupt ends a sleep. If interrupts are on, its handler is called.
static inline void core_enable_interrupt(unsigned number) {
  const uint32_t bit = UINT32_C(1) << number;
  store(EU_BASE + EU_MASK_OR_OFFSET, bit);
  store(EU_BASE + EU_MASK_IRQ_OR_OFFSET, bit);
}

// Sleeps until an enabled interrupt is pending, also with interrupts off.
static inline void core_sleep(void) {
  event_load(EU_BASE + EU_WAIT_OFFSET);
}

// Sleeps until the fabric controller's event `event` is pending, and clears this event. Other events stay pending.
static inline void core_sleep_until(unsigned event) {
  const uint32_t mask = load(EU_BASE + EU_MASK_OFFSET);
  store(EU_BASE + EU_MASK_OFFSET, UINT32_C(1) << event);
  event_load(EU_BASE + EU_WAIT_CLEAR_OFFSET);
  store(EU_BASE + EU_MASK_OFFSET, mask);
}

// Ends the program with an exit code.
void core_end(int code);

#ifdef __cplusplus
}
#endif
