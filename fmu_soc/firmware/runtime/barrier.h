// SPDX-License-Identifier: Apache-2.0
// Address at which a core of the cluster waits for the others. This file is for boards with MEbots' event unit.
#pragma once

#include "board.h"

#define BARRIER_ADDRESS (EVENT_UNIT_BASE + EVENT_UNIT_BARRIER_WAIT_OFFSET)
