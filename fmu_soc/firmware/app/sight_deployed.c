// SPDX-License-Identifier: Apache-2.0
// Implements sight.h with a deployed network that has the same outputs in the same order.
#include "app/deployed.h"
#include "app/sight.h"

sight_t cluster_sight(const uint8_t* frame, int width, int height) {
  int8_t values[4];
  sight_t sight = {0, 0, 0, -127};
  if (deployed_look(frame, width, height, values, 4)) {
    sight.yaw = values[0];
    sight.rise = values[1];
    sight.size = values[2];
    sight.visible = values[3];
  }
  return sight;
}
