// SPDX-License-Identifier: Apache-2.0
// Computes the integral image of the camera's reduced picture, for the gate finder.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

// Largest edge of a work picture [px]: half the edge of the HM01B0's 324.
#define WORK_MAX 162

typedef struct {
  int width;      // [px]
  int height;     // [px]
  int reduction;  // camera pixels per pixel of the work picture, along each axis
  // integral[y * (width + 1) + x] is the sum of the grey levels above row y and left of column x.
  uint32_t integral[(WORK_MAX + 1) * (WORK_MAX + 1)];
} work_picture_t;

// Computes the means of blocks of reduction x reduction pixels, and their integral image. Uses the smallest reduction
// at which the picture fits. Returns false if the picture is smaller than 64 pixels or larger than 4 x WORK_MAX in one
// direction.
bool work_picture_make(work_picture_t* work, const uint8_t* frame, int width, int height);

#ifdef __cplusplus
}
#endif
