// SPDX-License-Identifier: Apache-2.0
// The navigator of the neural network on the chip: the cluster is on only while it computes. A chip without a cluster
// takes the plain code of navigator_network.c, whose answers are the same.
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
