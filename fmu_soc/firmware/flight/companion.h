// SPDX-License-Identifier: Apache-2.0
// Receives set-points from a companion chip by UART.
#pragma once

#include <stdint.h>

// Reads the bytes that have arrived, and stores the set-points of valid frames into the registers of the commander.
// Must be called in each loop. `time_us` is the time since reset, modulo 2^32.
//
// Between frames, the last set-points remain valid. If a drone that takes off or flies receives no valid frame for
// COMPANION_TIMEOUT_MS, it starts to land. It continues to land until a valid frame arrives.
void companion_update(uint32_t time_us);

// The timeout is the time of ten pictures if a mission takes ten pictures per second.
#define COMPANION_TIMEOUT_MS 1000
