// SPDX-License-Identifier: Apache-2.0
// Where to fly, as a picture tells it: the place where one way of seeing (the gate finder, a neural network) is
// exchanged for another.
#pragma once

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
  // Wanted yaw rate as a part of the mission's scale: 127 = all to the left, -127 = all to the right. Proportional to
  // how far the gate lies from the middle of the picture; +-127 is the picture's edge. 0 if confidence is 0.
  int8_t yaw;
  // 0 = no gate in the picture, 255 = as sure as it gets.
  uint8_t confidence;
  // Distance from the camera to the gate's plane [mm] if the picture tells, else 0.
  uint16_t distance_mm;
} navigator_output_t;

// Looks at one picture of 8-bit grey pixels, row by row from the top left. Keeps nothing from call to call.
typedef navigator_output_t navigator_t(const uint8_t* frame, int width, int height);

// The classical gate finder: tells all three.
navigator_t finder_navigate;
// The neural network: tells the yaw alone, with full confidence; confidence 0 for a picture under 168 x 168.
navigator_t network_navigate;
// The same network on the chip's cluster, for pictures up to 324 x 324.
navigator_t cluster_navigate;

#ifdef __cplusplus
}
#endif
