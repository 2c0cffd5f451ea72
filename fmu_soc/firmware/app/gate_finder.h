// SPDX-License-Identifier: Apache-2.0
// Finds a square frame with a square opening in a grey picture: 8-bit pixels, integer arithmetic, no memory from
// picture to picture.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

// A frame in the picture. Places and lengths in pixels of the picture given, in sixteenths.
typedef struct {
  int32_t center_x_q4;  // from the left edge
  int32_t center_y_q4;  // from the upper edge
  int32_t width_q4;     // outer width of the frame
  int32_t height_q4;    // outer height of the frame
  uint8_t contrast;     // of the frame's weakest side, less half the difference between its sides [grey levels]
} gate_view_t;

// Looks for the frame in a picture of `width` x `height` pixels, row by row from the top left; both between 64 and
// 4 x 162. Returns whether there is one; then *view says where.
bool find_gate(const uint8_t* frame, int width, int height, gate_view_t* view);

#ifdef __cplusplus
}
#endif
