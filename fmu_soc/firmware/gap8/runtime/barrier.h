// SPDX-License-Identifier: Apache-2.0
// Address that a cluster core loads to wait at a barrier of GAP8's event unit.
#pragma once

#include "runtime/registers.h"

#define BARRIER_ADDRESS (EU_BASE + EU_BARRIER_OFFSET + BARRIER_ARRIVE_WAIT_OFFSET)
