// SPDX-License-Identifier: Apache-2.0
// Interrupts and sleep of the fabric controller.
//
// An interrupt handler only stores a note of the event. The main program does the work after its sleep. To lose no
// wake-up, the main program switches interrupts off, checks the note, and sleeps. A pending interrupt ends the sleep
// even with interrupts off. Then the program switches interrupts on briefly, so that the handler runs, and checks the
// note again.
#pragma once

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

// A handler runs with interrupts off. It must clear its device's request.
typedef void (*interrupt_handler_t)(void);

// Sets the handler of interrupt `number` (bit of mie and mip, below 32), and enables the interrupt.
void interrupt_attach(unsigned number, interrupt_handler_t handler);

static inline void interrupts_off(void) {
  __asm__ volatile("csrci mstatus, 8" ::: "memory");
}
static inline void interrupts_on(void) {
  __asm__ volatile("csrsi mstatus, 8" ::: "memory");
}

// Sets the clock of the core during a sleep [Hz]. If this clock is not below the core's present clock, or was never
// set, the clock does not change.
void sleep_clock_set(uint32_t hz);
// Sets the clock of a sleep if it is lower than the present clock. Returns the clock before this call [Hz].
uint32_t sleep_clock_lower(void);

// Sleeps until an attached interrupt is pending, then runs its handler. Interrupts must be off, and are off at return.
void sleep_until_interrupt(void);

#ifdef __cplusplus
}
#endif
