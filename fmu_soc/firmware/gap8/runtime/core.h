// SPDX-License-Identifier: Apache-2.0
// Controls the clock and the sleep of GAP8's fabric controller, and the end of its program. Uses the frequency-locked
// loop, the event unit and the SoC control.
#pragma once

#include <stdint.h>

#include "runtime/event_load.h"
#include "runtime/registers.h"

#ifdef __cplusplus
extern "C" {
#endif

uint32_t core_clock_hz(void);
// Sets the fabric controller's clock as loop_set() does (runtime/chip.h). While the UART or I2C1 sends, ignores a lower
// frequency, because the bit rate depends on this clock. Call this function again before each sleep: no interrupt
// reports the end of a transfer by the UART.
void core_clock_set(uint32_t hz);

// Enables interrupt `number`. An enabled interrupt ends a sleep and, if interrupts are on, calls its handler.
static inline void core_enable_interrupt(unsigned number) {
  const uint32_t bit = UINT32_C(1) << number;
  store(EU_BASE + EU_MASK_OR_OFFSET, bit);
  store(EU_BASE + EU_MASK_IRQ_OR_OFFSET, bit);
}

// Sleeps until an enabled interrupt is pending. Interrupts may be off.
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

void core_end(int code);

#ifdef __cplusplus
}
#endif
