// SPDX-License-Identifier: Apache-2.0
// Handles events of GAP8's SoC: ends of uDMA transfers, and changes of power and clocks. They share one interrupt of
// the fabric controller.
#pragma once

#include "runtime/interrupt.h"

void soc_events_start(void);
// Unmasks event `number` and sets its handler, which is called like an interrupt handler.
void soc_event_attach(unsigned number, interrupt_handler_t handler);
// Sleeps until `note` is not zero. The handler of an event must set `note`. During the sleep, handlers of other events
// are called, but no interrupts are taken.
void soc_event_wait(const volatile unsigned* note);
