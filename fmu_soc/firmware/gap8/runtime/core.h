// SPDX-License-Identifier: Apache-2.0
// What differs between chips in the fabric controller's clock, sleep and end. Here: GAP8's loops, event unit and SoC
// control.
#pragma once

#include <stdint.h>

#include "runtime/event_load.h"
#include "runtime/registers.h"

#ifdef __cplusplus
extern "C" {
#endif

// The clock now [Hz].
uint32_t core_clock_hz(void);
// The loop takes the nearest frequency that it has. While a peripheral whose bits are counted in this clock sends, a
// lower one is passed over: the transfer's end is an interrupt. A last byte that is still on the wire is none: the
// clock stays until the next sleep.
void core_clock_set(uint32_t hz);

// Lets interrupt `number` in: it ends a sleep, and comes when interrupts are on.
static inline void core_enable_interrupt(unsigned number) {
  const uint32_t bit = UINT32_C(1) << number;
  store(EU_BASE + EU_MASK_OR_OFFSET, bit);
  store(EU_BASE + EU_MASK_IRQ_OR_OFFSET, bit);
}

// Sleeps until an interrupt that is let in is pending, also with interrupts off.
static inline void core_sleep(void) {
  event_load(EU_BASE + EU_WAIT_OFFSET);
}

// Sleeps until one event of the fabric controller's comes, and takes it; others wait meanwhile.
static inline void core_sleep_until(unsigned event) {
  const uint32_t mask = load(EU_BASE + EU_MASK_OFFSET);
  store(EU_BASE + EU_MASK_OFFSET, UINT32_C(1) << event);
  event_load(EU_BASE + EU_WAIT_CLEAR_OFFSET);
  store(EU_BASE + EU_MASK_OFFSET, mask);
}

// The program ends.
void core_end(int code);

#ifdef __cplusplus
}
#endif
