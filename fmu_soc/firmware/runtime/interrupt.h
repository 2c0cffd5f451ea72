// SPDX-License-Identifier: Apache-2.0
// Interrupts and sleep of the fabric controller.
//
// An interrupt handler only takes note of what happened; the work is done by the code that sleeps and wakes up.
// The order that loses no wake-up. Interrupts off, look at the note, sleep (a pending interrupt ends the sleep even
// with interrupts off), interrupts on for a moment so that the handler runs, look again.
#pragma once

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

// A handler runs with interrupts off. It must make its device drop the request.
typedef void (*interrupt_handler_t)(void);

// Calls `handler` when interrupt `number` (bit of mie and mip, below 32) comes, and lets it in.
void interrupt_attach(unsigned number, interrupt_handler_t handler);

static inline void interrupts_off(void) {
  __asm__ volatile("csrci mstatus, 8" ::: "memory");
}
static inline void interrupts_on(void) {
  __asm__ volatile("csrsi mstatus, 8" ::: "memory");
}

// Clock of the core while it sleeps [Hz]; at first, and when it is not below the clock at which the core goes to sleep,
// the clock stays as it is.
void sleep_clock_set(uint32_t hz);
// Takes that clock, for a sleep for good; returns the clock before [Hz].
uint32_t sleep_clock_lower(void);

// Sleeps until an attached interrupt is pending, then lets its handler run.
// Call with interrupts off; they are off again on return.
void sleep_until_interrupt(void);

#ifdef __cplusplus
}
#endif
