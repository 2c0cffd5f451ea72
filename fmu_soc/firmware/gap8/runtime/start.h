/* SPDX-License-Identifier: Apache-2.0 */
/* What crt0.S does for a chip. Here GAP8's: a vector for each interrupt and no mie, whose place the event unit's masks
   take. */
#pragma once

#define TRAP_VECTORS trap_vectors
#define NO_INTERRUPT
#define START_CHIP call chip_start
