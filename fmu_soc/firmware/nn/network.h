// SPDX-License-Identifier: Apache-2.0
// Defines the shape and the weights of a network, and the arithmetic of all kernels. shape.h selects one of two
// networks. The navigator network is Stargate's network with only the camera as input. The sight network has twice as
// many channels in its first layers.
//
//   picture 168x168x1 (int8) -> 5x5/2, 4 or 8 channels -> largest of 2x2 -> [3x3/2, 3x3] 4 or 8 -> [3x3/2, 3x3] 16
//                            -> [3x3/2, 3x3] 32 -> dense 1152 -> 1 or 4
//
// A convolution's output is clip((sum of weight x input + bias) >> shift, 0, 255) with zeros around the picture and one
// bias and shift for each output channel. The bias contains half of 1 << shift, so that the shift rounds half up. The
// output of the dense layer is clip((sum + bias) >> shift, -127, 127). A tensor is stored row by row, with all channels
// of a position together. examples/paper/training produces the weights and defines the same arithmetic in Python.
#pragma once

#include <stdint.h>

#include "nn/shape.h"
#include "nn/shrink.h"

#ifdef __cplusplus
extern "C" {
#endif

#define NN_CONVOLUTIONS 7
#define NN_LAYERS (NN_CONVOLUTIONS + 1)
#define NN_PICTURE_BYTES (SHRUNK_EDGE * SHRUNK_EDGE)

typedef struct {
  uint8_t in_edge;
  uint8_t in_channels;
  uint8_t out_edge;  // edge before pooling
  uint8_t out_channels;
  uint8_t kernel;
  uint8_t stride;
} nn_shape_t;

// Shapes of the convolutions. The first output is pooled: maximum of 2 x 2 positions.
extern const nn_shape_t nn_shapes[NN_CONVOLUTIONS];
#define NN_POOLED_EDGE 42
#define NN_FEATURES (6 * 6 * NN_CHANNELS_FOURTH)

typedef struct {
  const int32_t* biases;  // one for each output channel
  const uint8_t* shifts;  // one for each output channel, from 1 to 15
  const int8_t* weights;  // sorted by output channel, row, column, input channel
} nn_layer_t;

// Returns the parameters of a layer: 0 to NN_CONVOLUTIONS - 1, or NN_CONVOLUTIONS for the dense layer. The biases,
// shifts and weights are each aligned to a word.
nn_layer_t nn_layer(int index);

// Returns the hash of a tensor's bytes (FNV-1a, 32 bits), to compare layers between machines.
uint32_t nn_checksum(const void* bytes, int count, uint32_t hash);
#define NN_CHECKSUM_START 2166136261U

// Outputs of all convolutions. The first output is pooled.
typedef struct {
  uint8_t pooled[NN_POOLED_EDGE * NN_POOLED_EDGE * NN_CHANNELS_FIRST];
  uint8_t second[21 * 21 * NN_CHANNELS_SECOND];
  uint8_t third[21 * 21 * NN_CHANNELS_SECOND];
  uint8_t fourth[11 * 11 * NN_CHANNELS_THIRD];
  uint8_t fifth[11 * 11 * NN_CHANNELS_THIRD];
  uint8_t sixth[6 * 6 * NN_CHANNELS_FOURTH];
  uint8_t seventh[NN_FEATURES];
} nn_activations_t;

// Outputs of the network, each in [-127, 127], where 127 means 1. A single output is a number instead of a struct.
#if NN_OUTPUTS == 1
typedef int8_t nn_output_t;
#define NN_OUTPUT(output, index) (output)
#define NN_NO_OUTPUT 0
#else
typedef struct {
  int8_t of[NN_OUTPUTS];
} nn_output_t;
#define NN_OUTPUT(output, index) ((output).of[index])
#define NN_NO_OUTPUT \
  {                  \
    { 0 }            \
  }
#endif

// Computes the whole network in plain C on one core. Stores the outputs of the layers in `activations`.
nn_output_t nn_plain_infer(const int8_t picture[NN_PICTURE_BYTES], nn_activations_t* activations);

#ifdef __cplusplus
}
#endif
