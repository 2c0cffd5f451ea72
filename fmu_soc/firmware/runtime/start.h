/* SPDX-License-Identifier: Apache-2.0 */
/* Chip-specific part of crt0.S, for boards with MEbots' own devices. All traps go to one address (mtvec in direct
   mode: a multiple of four). No device must be initialised. */
#pragma once

#define TRAP_VECTORS trap_entry
#define NO_INTERRUPT csrw mie, zero
#define START_CHIP
