// SPDX-License-Identifier: Apache-2.0
// Defines the address that a core of the cluster loads to wait at a barrier. This file is for boards with MEbots' event
// unit.
#pragma once

#include "board.h"

#define BARRIER_ADDRESS (EVENT_UNIT_BASE + EVENT_UNIT_BARRIER_WAIT_OFFSET)
