// SPDX-License-Identifier: Apache-2.0
// Declares the outputs of the sight network (examples/paper/training/sight.py).
#pragma once

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

// Values are in 127ths. If the picture could not be processed, `visible` is -127.
typedef struct {
  int8_t yaw;      // distance of the opening's middle to the left of the picture's middle / half the picture's width
  int8_t rise;     // distance of the opening's middle above the picture's middle / half the picture's height
  int8_t size;     // half the frame's edge in the picture / half the picture's width / SIGHT_MOST_SIZE
  int8_t visible;  // > 0: a gate is in the picture
} sight_t;

#define SIGHT_MOST_SIZE 2

// Processes one picture of 8-bit grey pixels, row by row from the top left.
sight_t cluster_sight(const uint8_t* frame, int width, int height);

#ifdef __cplusplus
}
#endif
