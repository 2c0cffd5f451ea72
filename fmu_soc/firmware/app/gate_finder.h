// SPDX-License-Identifier: Apache-2.0
// Finds a square frame with a square opening in a picture of 8-bit grey pixels, with integer arithmetic.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

// A frame in the picture. Positions and lengths are in sixteenths of the picture's pixels.
typedef struct {
  int32_t center_x_q4;  // distance from the left edge of the picture
  int32_t center_y_q4;  // distance from the upper edge of the picture
  int32_t width_q4;     // outer width
  int32_t height_q4;    // outer height
  uint8_t contrast;     // contrast of the weakest side, minus half the difference between the sides [grey levels]
} gate_view_t;

// Searches for a gate in the picture `frame`, which contains `width` x `height` pixels, row by row from the top left.
// `width` and `height` must be from 64 to 648. If the picture shows a gate, stores it in *view and returns true.
bool find_gate(const uint8_t* frame, int width, int height, gate_view_t* view);

#ifdef __cplusplus
}
#endif
