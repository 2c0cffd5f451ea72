// SPDX-License-Identifier: Apache-2.0
// Computes the reduced picture of the camera as an integral image, for the gate finder.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

// Largest edge of a work picture [px], which is half the edge of the HM01B0's 324.
#define WORK_MAX 162

typedef struct {
  int width;      // [px]
  int height;     // [px]
  int reduction;  // number of camera pixels per pixel of the work picture, along each axis
  // integral[y * (width + 1) + x] is the sum of all grey levels above row y and left of column x.
  uint32_t integral[(WORK_MAX + 1) * (WORK_MAX + 1)];
} work_picture_t;

// Averages blocks of reduction x reduction pixels and computes the sums. The reduction is the smallest at which the
// picture fits. Returns false if the picture is smaller than 64 pixels or larger than 4 x WORK_MAX in one direction.
bool work_picture_make(work_picture_t* work, const uint8_t* frame, int width, int height);

#ifdef __cplusplus
}
#endif
