// SPDX-License-Identifier: Apache-2.0
// Declares navigators, which compute the direction to the gate from a picture, by the gate finder or by a neural
// network.
#pragma once

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
  // Desired yaw rate in 127ths of the mission's yaw rate scale; positive = left. The value is proportional to the
  // distance of the gate from the middle of the picture: +-127 at the edge of the picture. If confidence is 0, the
  // value is 0.
  int8_t yaw;
  // 0 = no gate is in the picture, 255 = full confidence.
  uint8_t confidence;
  // Distance from the camera to the gate's plane [mm]; 0 = unknown.
  uint16_t distance_mm;
} navigator_output_t;

// Processes one picture of 8-bit grey pixels, row by row from the top left.
typedef navigator_output_t navigator_t(const uint8_t* frame, int width, int height);

// Uses the gate finder. Sets all outputs.
navigator_t finder_navigate;
// Uses the neural network. Sets only the yaw, with full confidence. If the picture is smaller than 168 x 168, sets
// confidence to 0.
navigator_t network_navigate;
// Uses the neural network on the chip's cluster. The picture may have up to 324 x 324 pixels.
navigator_t cluster_navigate;

#ifdef __cplusplus
}
#endif
