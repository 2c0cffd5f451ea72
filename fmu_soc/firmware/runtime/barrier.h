// SPDX-License-Identifier: Apache-2.0
// Address that a cluster core loads to wait at a barrier, on boards with MEbots' event unit.
#pragma once

#include "board.h"

#define BARRIER_ADDRESS (EVENT_UNIT_BASE + EVENT_UNIT_BARRIER_WAIT_OFFSET)
