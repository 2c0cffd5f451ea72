// SPDX-License-Identifier: Apache-2.0
// Sets GAP8's clocks and voltage. Their initial values are those of boards without GAP8's power unit.
#pragma once

#include <stdint.h>

#include "board.h"

// Initial clocks of fabric controller and cluster [Hz]. A board with a mission device takes them from the mission.
#ifdef MISSION_BASE
#define START_CLOCK_HZ MISSION_CORE_CLOCK
#define START_CLUSTER_CLOCK_HZ MISSION_CLUSTER_CLOCK
#else
#define START_CLOCK_HZ 100000000
#define START_CLUSTER_CLOCK_HZ 87000000
#endif

enum { LOOP_SOC, LOOP_CLUSTER };

// Sets clocks, timer, interrupts of the SoC and the console. Must be called before main().
void chip_start(void);

uint32_t loop_hz(unsigned loop);
// Sets a loop to the nearest possible frequency not above `hz`. Returns 0. If `hz` is below the reference clock or
// above the limit at the present voltage, has no effect and returns -1.
int loop_set(unsigned loop, uint32_t hz);
