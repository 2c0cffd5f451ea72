// SPDX-License-Identifier: Apache-2.0
#include "nn/network.h"

const nn_shape_t nn_shapes[NN_CONVOLUTIONS] = {
    {168, 1, 84, NN_CHANNELS_FIRST, 5, 2},
    {42, NN_CHANNELS_FIRST, 21, NN_CHANNELS_SECOND, 3, 2},
    {21, NN_CHANNELS_SECOND, 21, NN_CHANNELS_SECOND, 3, 1},
    {21, NN_CHANNELS_SECOND, 11, NN_CHANNELS_THIRD, 3, 2},
    {11, NN_CHANNELS_THIRD, 11, NN_CHANNELS_THIRD, 3, 1},
    {11, NN_CHANNELS_THIRD, 6, NN_CHANNELS_FOURTH, 3, 2},
    {6, NN_CHANNELS_FOURTH, 6, NN_CHANNELS_FOURTH, 3, 1},
};

// Contents of the file that training has written (see weights.S): biases, shifts and weights of each layer, each padded
// with zeros to whole words.
extern const uint8_t nn_weights_file[];

static int words(int bytes) {
  return (bytes + 3) & ~3;
}

nn_layer_t nn_layer(int index) {
  const uint8_t* at = nn_weights_file;
  for (int i = 0;; ++i) {
    const nn_shape_t* shape = &nn_shapes[i];
    const int channels = i < NN_CONVOLUTIONS ? shape->out_channels : NN_OUTPUTS;
    const int per_channel = i < NN_CONVOLUTIONS ? shape->kernel * shape->kernel * shape->in_channels : NN_FEATURES;
    const uint8_t* shifts = at + 4 * channels;
    const uint8_t* weights = shifts + words(channels);
    if (i == index) {
      const nn_layer_t layer = {(const int32_t*)(const void*)at, shifts, (const int8_t*)weights};
      return layer;
    }
    at = weights + words(channels * per_channel);
  }
}

uint32_t nn_checksum(const void* bytes, int count, uint32_t hash) {
  const uint8_t* b = bytes;
  for (int i = 0; i < count; ++i) {
    hash = (hash ^ b[i]) * 16777619U;
  }
  return hash;
}
