// SPDX-License-Identifier: Apache-2.0
// Reduces the camera's picture to 168 x 168 pixels, the network's input. Each pixel is the rounded mean of 2 x 2 camera
// pixels, minus 128. The camera pixels are evenly spaced from edge to edge, for example 40/21 pixels apart in a picture
// of 320 pixels.
#pragma once

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SHRUNK_EDGE 168

// Returns the first of the two source rows (or columns) for network row (or column) `index`. `length`, the number of
// source rows (or columns), must be at least SHRUNK_EDGE.
static inline int shrink_place(int index, int length) {
  return index * (length - 2) / (SHRUNK_EDGE - 1);
}

// Computes the source column of each column of the network's picture. The source is `width` pixels wide.
void shrink_columns(int width, uint16_t columns[SHRUNK_EDGE]);

// Computes one row of the network's picture from source rows `upper` and `upper + width`.
void shrink_row(const uint8_t* upper, int width, const uint16_t columns[SHRUNK_EDGE], int8_t row[SHRUNK_EDGE]);

#ifdef __cplusplus
}
#endif
