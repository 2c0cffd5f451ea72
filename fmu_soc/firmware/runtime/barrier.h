// SPDX-License-Identifier: Apache-2.0
// Where a core of the cluster waits for the others. Here: boards with our event unit.
#pragma once

#include "board.h"

#define BARRIER_ADDRESS (EVENT_UNIT_BASE + EVENT_UNIT_BARRIER_WAIT_OFFSET)
