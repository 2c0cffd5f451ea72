// SPDX-License-Identifier: Apache-2.0
// Outputs of the sight network, as defined in examples/paper/training/sight.py.
#pragma once

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

// All values are in 127ths. If the picture could not be processed, visible is -127.
typedef struct {
  int8_t yaw;      // middle of the opening: distance to the left of the picture's middle / half the picture's width
  int8_t rise;     // middle of the opening: distance above the picture's middle / half the picture's height
  int8_t size;     // half the frame's edge / half the picture's width / SIGHT_MOST_SIZE
  int8_t visible;  // above 0: there is a gate
} sight_t;

#define SIGHT_MOST_SIZE 2

// Processes one picture of 8-bit grey pixels, row by row from the top left. Keeps no state between calls.
sight_t cluster_sight(const uint8_t* frame, int width, int height);

#ifdef __cplusplus
}
#endif
