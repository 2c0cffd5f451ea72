// SPDX-License-Identifier: Apache-2.0
// Defines the address at which a core of the cluster waits for the others. This file is for GAP8's event unit.
#pragma once

#include "runtime/registers.h"

#define BARRIER_ADDRESS (EU_BASE + EU_BARRIER_OFFSET + BARRIER_ARRIVE_WAIT_OFFSET)
