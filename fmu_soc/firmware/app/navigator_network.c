// SPDX-License-Identifier: Apache-2.0
// Implements the navigator with the neural network, whose only output is the yaw.
#include "app/navigator.h"
#include "nn/network.h"
#include "nn/shrink.h"

static int8_t picture[NN_PICTURE_BYTES] __attribute__((aligned(4), section(".noinit.picture")));
static nn_activations_t activations __attribute__((aligned(4), section(".noinit.activations")));

navigator_output_t network_navigate(const uint8_t* frame, int width, int height) {
  navigator_output_t output = {0, 0, 0};
  if (width < SHRUNK_EDGE || height < SHRUNK_EDGE) {
    return output;
  }
  uint16_t columns[SHRUNK_EDGE];
  shrink_columns(width, columns);
  for (int y = 0; y < SHRUNK_EDGE; ++y) {
    shrink_row(&frame[shrink_place(y, height) * width], width, columns, &picture[y * SHRUNK_EDGE]);
  }
  output.yaw = nn_plain_infer(picture, &activations);
  output.confidence = UINT8_MAX;
  return output;
}
