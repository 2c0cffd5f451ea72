// SPDX-License-Identifier: Apache-2.0
#include "runtime/soc_events.h"

#include <stddef.h>

#include "runtime/core.h"

#define VALID (UINT32_C(1) << 31)
#define NUMBER_MASK (SOC_EVENTS - 1)

static interrupt_handler_t handlers[SOC_EVENTS];

static void on_soc_event(void) {
  for (;;) {
    const uint32_t event = load(EVENT_UNIT_BASE + EU_SOC_EVENT_OFFSET);
    if ((event & VALID) == 0) {
      return;
    }
    const interrupt_handler_t handler = handlers[event & NUMBER_MASK];
    if (handler != NULL) {
      handler();
    }
  }
}

void soc_events_start(void) {
  interrupt_attach(FABRIC_EVENT_SOC, on_soc_event);
}

void soc_event_attach(unsigned number, interrupt_handler_t handler) {
  handlers[number] = handler;
  const uint32_t mask = SOC_EVENTS_BASE + SOC_EVENT_MASKS_OFFSET + (number < 32 ? 4 : 0);
  store(mask, load(mask) & ~(UINT32_C(1) << number % 32));
}

// Interrupts are off during the wait. Otherwise an interrupt between the check of `note` and the sleep would clear the
// event that ends the sleep. p.elw also returns with interrupts off.
void soc_event_wait(const volatile unsigned* note) {
  uint32_t status;
  __asm__ volatile("csrrci %0, mstatus, 8" : "=r"(status)::"memory");
  while (*note == 0) {
    core_sleep_until(FABRIC_EVENT_SOC);
    on_soc_event();
  }
  __asm__ volatile("csrs mstatus, %0" ::"r"(status & 8) : "memory");
}
