// SPDX-License-Identifier: Apache-2.0
// What the sight network tells of a picture; examples/paper/training/sight.py defines it.
#pragma once

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

// Each in 127ths. A picture that could not be looked at has visible = -127.
typedef struct {
  int8_t yaw;      // middle of the opening, left of the picture's middle, over half the picture's width
  int8_t rise;     // the same upwards, over half its height
  int8_t size;     // half the frame's edge over half the picture's width, over SIGHT_MOST_SIZE
  int8_t visible;  // above 0: there is a gate
} sight_t;

#define SIGHT_MOST_SIZE 2

// Looks at one picture of 8-bit grey pixels, row by row from the top left. Keeps nothing from call to call.
sight_t cluster_sight(const uint8_t* frame, int width, int height);

#ifdef __cplusplus
}
#endif
