/* SPDX-License-Identifier: Apache-2.0 */
/* Defines the chip-specific part of crt0.S for GAP8. There is a vector for each interrupt. The chip has no mie. The
   masks of the event unit enable interrupts. */
#pragma once

#define TRAP_VECTORS trap_vectors
#define NO_INTERRUPT
#define START_CHIP call chip_start
