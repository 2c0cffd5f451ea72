// SPDX-License-Identifier: Apache-2.0
// Runs a network that `mebots deploy` has written.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

// Reduces the camera's picture to the size of the network's input, and computes the network's `count` outputs, in
// 127ths from -127 to 127. Returns false if the picture is smaller than the network's input or wider than 324 pixels,
// or if the chip has no cluster of eight cores.
bool deployed_look(const uint8_t* frame, int width, int height, int8_t* values, int count);

#ifdef __cplusplus
}
#endif
