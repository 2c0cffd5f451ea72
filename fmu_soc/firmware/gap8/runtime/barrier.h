// SPDX-License-Identifier: Apache-2.0
// Defines the address that a core of the cluster loads to wait at a barrier. This file is for GAP8's event unit.
#pragma once

#include "runtime/registers.h"

#define BARRIER_ADDRESS (EU_BASE + EU_BARRIER_OFFSET + BARRIER_ARRIVE_WAIT_OFFSET)
