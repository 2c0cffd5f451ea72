// SPDX-License-Identifier: Apache-2.0
// Runs the neural network on the cluster, which is only on during an inference. A chip without a cluster runs
// navigator_network.c, which has the same results.
#include <stdbool.h>

#include "app/navigator.h"
#include "nn/cluster_net.h"
#include "runtime/cluster.h"

navigator_output_t cluster_navigate(const uint8_t* frame, int width, int height) {
  static bool ready;
  if (!ready) {
    nn_cluster_init();
    ready = true;
  }
  navigator_output_t output = {0, 0, 0};
  if (!nn_cluster_takes(width, height)) {
    return output;
  }
  if (cluster_on() != 0) {
    return network_navigate(frame, width, height);
  }
  output.yaw = nn_cluster_infer(frame, width, height, cluster_core_count());
  output.confidence = UINT8_MAX;
  cluster_off();
  return output;
}
