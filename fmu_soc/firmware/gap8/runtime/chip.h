// SPDX-License-Identifier: Apache-2.0
// Sets GAP8's clocks and voltage. After the start, they have the same values as on boards without GAP8's power unit.
#pragma once

#include <stdint.h>

#include "board.h"

// Clocks of the fabric controller and the cluster at the start of the program [Hz]. If the board has a mission device,
// the mission determines them.
#ifdef MISSION_BASE
#define START_CLOCK_HZ MISSION_CORE_CLOCK
#define START_CLUSTER_CLOCK_HZ MISSION_CLUSTER_CLOCK
#else
#define START_CLOCK_HZ 100000000
#define START_CLUSTER_CLOCK_HZ 87000000
#endif

enum { LOOP_SOC, LOOP_CLUSTER };

// Sets clocks, time, interrupts of the SoC and the console. Must be called before main().
void chip_start(void);

// Returns the output frequency of a loop [Hz].
uint32_t loop_hz(unsigned loop);
// Sets a loop to the nearest possible frequency not above `hz`. Returns 0. If `hz` is below the reference clock or
// above what the voltage allows, has no effect and returns -1.
int loop_set(unsigned loop, uint32_t hz);
