// SPDX-License-Identifier: Apache-2.0
// Turns set-points (mode, velocity along the heading, yaw rate, altitude) into a point that moves, and decides when the
// motors run.
#pragma once

#include <stdbool.h>

#include "flight/controller.h"

// Advances by one loop. Returns true while the motors run.
bool goal_update(const flight_state_t* state, float range_m);
const flight_goal_t* goal_now(void);
