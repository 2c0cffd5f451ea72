// SPDX-License-Identifier: Apache-2.0
// Runs the network on the cluster, called by the fabric controller. While the cores reduce a stripe of the picture, the
// DMA copies the next stripe to L1. While the cores compute earlier layers, the DMA copies the large weights.
#pragma once

#include <stdbool.h>

#include "nn/network.h"

#ifdef __cplusplus
extern "C" {
#endif

// Must be called once, before the first inference.
void nn_cluster_init(void);

// Returns true if nn_cluster_infer() supports a picture of this size: both edges from 168 to 324 pixels, and a width
// that is a multiple of 4.
static inline bool nn_cluster_takes(int width, int height) {
  return width >= SHRUNK_EDGE && width <= 324 && width % 4 == 0 && height >= SHRUNK_EDGE && height <= 324;
}

// Computes the network's outputs on `cores` cores for a picture of 8-bit grey pixels in L2. The cluster must be on.
nn_output_t nn_cluster_infer(const uint8_t* frame, int width, int height, unsigned cores);

// Computes the network's outputs for a picture that is already reduced to 168 x 168 (grey level minus 128).
nn_output_t nn_cluster_infer_shrunk(const int8_t picture[NN_PICTURE_BYTES], unsigned cores);

// Returns the hash of a layer's output (0 to 6) in the last inference. The cluster must still be on.
uint32_t nn_cluster_checksum(int layer);

#ifdef __cplusplus
}
#endif
