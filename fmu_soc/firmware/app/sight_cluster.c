// SPDX-License-Identifier: Apache-2.0
// Runs the sight network on the cluster, which is only on during an inference. A chip without a cluster runs the plain
// code, which has the same results.
#include <stdbool.h>

#include "app/sight.h"
#include "nn/cluster_net.h"
#include "nn/shrink.h"
#include "runtime/cluster.h"

static int8_t picture[NN_PICTURE_BYTES] __attribute__((aligned(4), section(".noinit.picture")));
static nn_activations_t activations __attribute__((aligned(4), section(".noinit.activations")));

static nn_output_t plain_output(const uint8_t* frame, int width, int height) {
  uint16_t columns[SHRUNK_EDGE];
  shrink_columns(width, columns);
  for (int y = 0; y < SHRUNK_EDGE; ++y) {
    shrink_row(&frame[shrink_place(y, height) * width], width, columns, &picture[y * SHRUNK_EDGE]);
  }
  return nn_plain_infer(picture, &activations);
}

sight_t cluster_sight(const uint8_t* frame, int width, int height) {
  static bool ready;
  if (!ready) {
    nn_cluster_init();
    ready = true;
  }
  const sight_t none = {0, 0, 0, -127};
  if (!nn_cluster_takes(width, height)) {
    return none;
  }
  nn_output_t output;
  if (cluster_on() == 0) {
    output = nn_cluster_infer(frame, width, height, cluster_core_count());
    cluster_off();
  } else {
    output = plain_output(frame, width, height);
  }
  const sight_t sight = {output.of[0], output.of[1], output.of[2], output.of[3]};
  return sight;
}
