// SPDX-License-Identifier: Apache-2.0
// GAP8's clocks and voltage: after the start as on our boards without a power unit of GAP8's.
#pragma once

#include <stdint.h>

#include "board.h"

// Clocks of the fabric controller and the cluster from the start of the program on [Hz]: what the mission says, where
// the board has one.
#ifdef MISSION_BASE
#define START_CLOCK_HZ MISSION_CORE_CLOCK
#define START_CLUSTER_CLOCK_HZ MISSION_CLUSTER_CLOCK
#else
#define START_CLOCK_HZ 100000000
#define START_CLUSTER_CLOCK_HZ 87000000
#endif

enum { LOOP_SOC, LOOP_CLUSTER };

// Before main(): clocks, time, interrupts of the SoC, console.
void chip_start(void);

// The frequency of a loop [Hz].
uint32_t loop_hz(unsigned loop);
// Sets it to the nearest one that it has, not above `hz`. 0, or -1 when the chip's voltage does not allow it.
int loop_set(unsigned loop, uint32_t hz);
