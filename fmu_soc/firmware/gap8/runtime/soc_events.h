// SPDX-License-Identifier: Apache-2.0
// Events of GAP8's SoC: the ends of the uDMA's transfers, and of changes of power and clocks. They come one after
// another through one interrupt of the fabric controller.
#pragma once

#include "runtime/interrupt.h"

// Lets their interrupt in.
void soc_events_start(void);
// Calls `handler`, as an interrupt's, when event `number` comes, and lets it through.
void soc_event_attach(unsigned number, interrupt_handler_t handler);
// Sleeps until `note` is not zero, which the handler of an event sets. Handlers of other events run meanwhile,
// interrupts do not, whether they are on or off.
void soc_event_wait(const volatile unsigned* note);
