// SPDX-License-Identifier: Apache-2.0
// Computes the network as network.h defines it, without packed words or stored borders. Tests compare the other kernels
// with this code.
#include "nn/network.h"

static int clip(int value, int low, int high) {
  return value < low ? low : value > high ? high : value;
}

// Returns the sum of one output channel at one output position, including the bias. `is_signed` must be true only for
// the first layer.
static int32_t sum_at(const nn_shape_t* shape, const nn_layer_t* layer, const uint8_t* input, int is_signed, int y,
                      int x, int channel) {
  const int edge = shape->in_edge;
  const int channels = shape->in_channels;
  const int kernel = shape->kernel;
  const int8_t* weight = layer->weights + channel * kernel * kernel * channels;
  int32_t sum = layer->biases[channel];
  for (int i = 0; i < kernel; ++i) {
    const int row = y * shape->stride + i - kernel / 2;
    for (int j = 0; j < kernel; ++j, weight += channels) {
      const int column = x * shape->stride + j - kernel / 2;
      if (row < 0 || row >= edge || column < 0 || column >= edge) {
        continue;
      }
      const uint8_t* values = input + (row * edge + column) * channels;
      for (int c = 0; c < channels; ++c) {
        sum += weight[c] * (is_signed ? (int8_t)values[c] : values[c]);
      }
    }
  }
  return sum;
}

static void convolve(int index, const uint8_t* input, uint8_t* output) {
  const nn_shape_t* shape = &nn_shapes[index];
  const nn_layer_t layer = nn_layer(index);
  for (int y = 0; y < shape->out_edge; ++y) {
    for (int x = 0; x < shape->out_edge; ++x) {
      for (int c = 0; c < shape->out_channels; ++c) {
        *output++ = (uint8_t)clip(sum_at(shape, &layer, input, 0, y, x, c) >> layer.shifts[c], 0, 255);
      }
    }
  }
}

// Computes and pools the first layer. Pools before the shift, because the greatest sum gives the greatest output.
static void convolve_and_pool(const int8_t* picture, uint8_t* output) {
  const nn_shape_t* shape = &nn_shapes[0];
  const nn_layer_t layer = nn_layer(0);
  for (int y = 0; y < shape->out_edge; y += 2) {
    for (int x = 0; x < shape->out_edge; x += 2) {
      for (int c = 0; c < shape->out_channels; ++c) {
        int32_t largest = INT32_MIN;
        for (int i = 0; i < 4; ++i) {
          const int32_t sum = sum_at(shape, &layer, (const uint8_t*)picture, 1, y + i / 2, x + i % 2, c);
          largest = sum > largest ? sum : largest;
        }
        *output++ = (uint8_t)clip(largest >> layer.shifts[c], 0, 255);
      }
    }
  }
}

nn_output_t nn_plain_infer(const int8_t picture[NN_PICTURE_BYTES], nn_activations_t* a) {
  convolve_and_pool(picture, a->pooled);
  convolve(1, a->pooled, a->second);
  convolve(2, a->second, a->third);
  convolve(3, a->third, a->fourth);
  convolve(4, a->fourth, a->fifth);
  convolve(5, a->fifth, a->sixth);
  convolve(6, a->sixth, a->seventh);
  const nn_layer_t dense = nn_layer(NN_CONVOLUTIONS);
  nn_output_t output;
  for (int o = 0; o < NN_OUTPUTS; ++o) {
    int32_t sum = dense.biases[o];
    for (int i = 0; i < NN_FEATURES; ++i) {
      sum += dense.weights[o * NN_FEATURES + i] * a->seventh[i];
    }
    NN_OUTPUT(output, o) = (int8_t)clip(sum >> dense.shifts[o], -127, 127);
  }
  return output;
}
