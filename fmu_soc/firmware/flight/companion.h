// SPDX-License-Identifier: Apache-2.0
// Receives set-points from a companion chip by UART.
#pragma once

#include <stdint.h>

// Reads the received bytes, and stores the set-points of valid frames into the commander's registers. Must be called in
// each loop. `time_us` is the time since reset, modulo 2^32.
//
// Between frames, the last set-points remain valid. If a drone that takes off or flies receives no valid frame for
// COMPANION_TIMEOUT_MS, it starts to land. It continues to land until a valid frame arrives.
void companion_update(uint32_t time_us);

// The time of ten pictures at ten pictures per second.
#define COMPANION_TIMEOUT_MS 1000
