// SPDX-License-Identifier: Apache-2.0
// Computes the desired state from the set-points, and decides when the motors run.
#pragma once

#include <stdbool.h>

#include "flight/controller.h"

// Advances the desired state by one loop. Returns true while the motors run.
bool goal_update(const flight_state_t* state, float range_m);
const flight_goal_t* goal_now(void);
