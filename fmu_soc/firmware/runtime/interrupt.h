// SPDX-License-Identifier: Apache-2.0
// Controls interrupts and sleep of the fabric controller.
//
// A handler should only set a flag, for which the main program waits. To lose no wake-up, the main program must switch
// interrupts off, check the flag, and sleep. A pending interrupt ends the sleep even with interrupts off. Then the
// program switches interrupts on briefly, so that the handler runs, and checks the flag again.
#pragma once

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

// An interrupt handler runs with interrupts off, and must clear the request of its device.
typedef void (*interrupt_handler_t)(void);

// Sets the handler of interrupt `number` and enables the interrupt. The number is the bit in mie and mip, below 32.
void interrupt_attach(unsigned number, interrupt_handler_t handler);

static inline void interrupts_off(void) {
  __asm__ volatile("csrci mstatus, 8" ::: "memory");
}
static inline void interrupts_on(void) {
  __asm__ volatile("csrsi mstatus, 8" ::: "memory");
}

// Sets the core's clock during a sleep [Hz]. Without this call, or if this clock is not lower than the present clock, a
// sleep does not change the clock.
void sleep_clock_set(uint32_t hz);
// Sets the clock for a sleep, if it is lower than the present clock. Returns the clock before this call [Hz].
uint32_t sleep_clock_lower(void);

// Sleeps until an attached interrupt is pending, and then runs its handler. Interrupts must be off at the call, and are
// off at return.
void sleep_until_interrupt(void);

#ifdef __cplusplus
}
#endif
