// SPDX-License-Identifier: Apache-2.0
// Events of GAP8's SoC: ends of uDMA transfers, and of changes of power and clocks. They share one interrupt of the
// fabric controller.
#pragma once

#include "runtime/interrupt.h"

// Enables the interrupt of SoC events.
void soc_events_start(void);
// Unmasks event `number`, and sets its handler, which runs like an interrupt handler.
void soc_event_attach(unsigned number, interrupt_handler_t handler);
// Sleeps until `note` is not zero. The handler of an event sets it. Handlers of other events run during the sleep. No
// interrupts are taken during the sleep, even if they are on.
void soc_event_wait(const volatile unsigned* note);
