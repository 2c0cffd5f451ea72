/* SPDX-License-Identifier: Apache-2.0 */
/* Defines the chip-specific part of crt0.S for boards with MEbots' own devices. All traps jump to the same address
   (mtvec in direct mode), which is a multiple of four. No device needs to be initialised. */
#pragma once

#define TRAP_VECTORS trap_entry
#define NO_INTERRUPT csrw mie, zero
#define START_CHIP
