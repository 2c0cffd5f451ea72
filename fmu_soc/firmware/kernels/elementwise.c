// SPDX-License-Identifier: Apache-2.0
// Implements operators that compute an output byte from the input bytes at the same position. Each core computes a
// contiguous part of the tile.
#include "kernels/requantise.h"
#include "kernels/work.h"

typedef struct {
  int32_t begin, end;
} range_t;

static range_t part_of(const layer_step_t* step, layer_share_t share) {
  const int32_t bytes = step->rows * step->layer->out_columns * step->channels;
  const int32_t each = ((bytes + share.cores - 1) / share.cores + 3) & ~3;
  const range_t part = {share.core * each, (share.core + 1) * each < bytes ? (share.core + 1) * each : bytes};
  return part;
}

void layer_add(const layer_step_t* step, layer_share_t share) {
  const layer_t* layer = step->layer;
  const range_t part = part_of(step, share);
  const int32_t f0 = layer->factors[0], f1 = layer->factors[1], addend = layer->addend, shift = layer->shift;
  const int32_t low = layer->low, high = layer->high;
  const uint8_t* a = step->in + part.begin;
  const uint8_t* b = step->other + part.begin;
  uint8_t* to = step->out + part.begin;
#pragma GCC unroll 4
  for (int32_t i = part.end - part.begin; i > 0; --i) {
    *to++ = (uint8_t)limited((*a++ * f0 + *b++ * f1 + addend) >> shift, low, high);
  }
}

void layer_multiply(const layer_step_t* step, layer_share_t share) {
  const layer_t* layer = step->layer;
  const range_t part = part_of(step, share);
  const int32_t z0 = layer->zeros[0], z1 = layer->zeros[1];
  for (int32_t i = part.begin; i < part.end; ++i) {
    const int32_t product = (step->in[i] - z0) * (step->other[i] - z1);
    const int32_t value =
        scaled(product, layer->factors[0], layer->addend, layer->shift, layer->scaling == SCALING_WIDE);
    step->out[i] = (uint8_t)limited(value, layer->low, layer->high);
  }
}

void layer_table(const layer_step_t* step, layer_share_t share) {
  const range_t part = part_of(step, share);
  const uint8_t* table = step->data;
  const uint8_t* in = step->in + part.begin;
  uint8_t* to = step->out + part.begin;
#pragma GCC unroll 4
  for (int32_t i = part.end - part.begin; i > 0; --i) {
    *to++ = table[*in++];
  }
}
