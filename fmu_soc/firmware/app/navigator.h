// SPDX-License-Identifier: Apache-2.0
// Interface of a navigator, which gets the direction to the gate from a picture: the gate finder, or a neural network.
#pragma once

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
  // Wanted yaw rate relative to the mission's scale: 127 = fully left, -127 = fully right. The value is proportional to
  // the distance of the gate from the middle of the picture; +-127 is the picture's edge. If confidence is 0, the value
  // is 0.
  int8_t yaw;
  // Confidence: 0 = no gate in the picture, 255 = full confidence.
  uint8_t confidence;
  // Distance from the camera to the gate's plane [mm]; 0 if unknown.
  uint16_t distance_mm;
} navigator_output_t;

// Processes one picture of 8-bit grey pixels, row by row from the top left. Keeps no state between calls.
typedef navigator_output_t navigator_t(const uint8_t* frame, int width, int height);

// The classical gate finder: sets yaw, confidence and distance.
navigator_t finder_navigate;
// The neural network. It only sets the yaw, with full confidence. For a picture below 168 x 168, confidence is 0.
navigator_t network_navigate;
// Evaluates a picture of up to 324 x 324 pixels with the network on the chip's cluster.
navigator_t cluster_navigate;

#ifdef __cplusplus
}
#endif
