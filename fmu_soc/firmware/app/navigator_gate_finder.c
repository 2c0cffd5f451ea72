// SPDX-License-Identifier: Apache-2.0
// Implements the navigator with the gate finder: yaw from the gate's centre in the picture, distance from the gate's
// height.
#include "app/calibration.h"
#include "app/gate_finder.h"
#include "app/navigator.h"

// If the weakest side of the frame has this contrast [grey levels], the confidence is full.
#define FULL_CONFIDENCE_CONTRAST 32

navigator_output_t finder_navigate(const uint8_t* frame, int width, int height) {
  navigator_output_t output = {0, 0, 0};
  gate_view_t view;
  if (!find_gate(frame, width, height, &view)) {
    return output;
  }
  const int32_t middle_q4 = width * 8;
  const int32_t yaw = (middle_q4 - view.center_x_q4) * 127 / middle_q4;
  output.yaw = (int8_t)(yaw > 127 ? 127 : yaw < -127 ? -127 : yaw);
  const int32_t confidence = view.contrast * 255 / FULL_CONFIDENCE_CONTRAST;
  output.confidence = (uint8_t)(confidence > 255 ? 255 : confidence);
  // A frame that is seen from the side is narrower, but not lower. Therefore the height gives the distance: focal
  // length [px] * outer edge [mm] / height [px].
  const int32_t numerator = CAMERA_FOCAL_OVER_HALF_WIDTH_MILLI * GATE_OUTER_MM / 1000 * middle_q4;
  const int32_t distance_mm = numerator / view.height_q4;
  output.distance_mm = (uint16_t)(distance_mm > UINT16_MAX ? UINT16_MAX : distance_mm);
  return output;
}
