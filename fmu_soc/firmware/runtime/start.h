/* SPDX-License-Identifier: Apache-2.0 */
/* What crt0.S does for a chip. Here: boards with our devices. All traps go to one address (mtvec in direct mode: a
   multiple of four), and no device needs a start. */
#pragma once

#define TRAP_VECTORS trap_entry
#define NO_INTERRUPT csrw mie, zero
#define START_CHIP
