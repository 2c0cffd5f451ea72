// SPDX-License-Identifier: Apache-2.0
// The network on the cluster. The picture comes into L1 by DMA in stripes while the cores make the stripe before it
// small; the large weights while the cores compute the layers before they are needed. For the fabric controller.
#pragma once

#include <stdbool.h>

#include "nn/network.h"

#ifdef __cplusplus
extern "C" {
#endif

// Once, before the first inference.
void nn_cluster_init(void);

// Whether a picture has a size that nn_cluster_infer can take: 168 to 324 each way, the width a multiple of 4.
static inline bool nn_cluster_takes(int width, int height) {
  return width >= SHRUNK_EDGE && width <= 324 && width % 4 == 0 && height >= SHRUNK_EDGE && height <= 324;
}

// The network's outputs for a picture of 8-bit grey pixels in L2, on `cores` cores. The cluster must be on; L1 may hold
// anything.
nn_output_t nn_cluster_infer(const uint8_t* frame, int width, int height, unsigned cores);

// The same for a picture of 168 x 168 that is small already (grey level less 128), to compare with the golden vectors.
nn_output_t nn_cluster_infer_shrunk(const int8_t picture[NN_PICTURE_BYTES], unsigned cores);

// Hash of layer 0 to 6's output of the last inference, while the cluster is on.
uint32_t nn_cluster_checksum(int layer);

#ifdef __cplusplus
}
#endif
