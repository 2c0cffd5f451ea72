// SPDX-License-Identifier: Apache-2.0
// Computes convolutions with any kernel, stride, dilation and groups: two output positions and four channels at a time.
// convolve_blocks.c is faster, but supports no groups.
#include "kernels/products.h"
#include "kernels/requantise.h"
#include "kernels/work.h"

static inline __attribute__((always_inline)) void row_of_places(const layer_t* layer, const layer_group_t* group,
                                                                const uint8_t* patch, int32_t to_next, uint8_t* to,
                                                                int32_t columns, int32_t channels, int scaling) {
  int32_t sums[8];
  for (; columns > 1; columns -= 2, patch += 2 * to_next, to += 2 * channels) {
    add_products(layer, group, patch, to_next, sums, 1, scaling);
    store_places(layer, group, sums, to, channels, 2, scaling);
  }
  if (columns > 0) {
    add_products(layer, group, patch, to_next, sums, 0, scaling);
    store_places(layer, group, sums, to, channels, 1, scaling);
  }
}

static inline __attribute__((always_inline)) void convolve(const layer_step_t* step, layer_share_t share, int scaling) {
  const layer_t* layer = step->layer;
  const int32_t rows = step->rows * layer->pool;
  const int32_t columns = layer->out_columns * layer->pool;
  const int32_t channels = step->channels * layer->element;
  uint8_t* out = layer->then != 0 ? step->unpooled : step->out;
  const int32_t to_next = layer->stride_columns * step->in_channels;
  // A unit of work is four output channels of one row of output positions.
  for (int32_t unit = share.core; unit < step->groups * rows; unit += share.cores) {
    const int32_t y = unit / step->groups;
    const int32_t number = unit - y * step->groups;
    const layer_group_t* group = (const layer_group_t*)(const void*)(step->data + number * layer->group_bytes);
    const uint8_t* patch = step->in + y * layer->stride_rows * step->in_pitch + group->in;
    uint8_t* to = out + y * columns * channels + group->out * layer->element;
    row_of_places(layer, group, patch, to_next, to, columns, channels, scaling);
  }
}

#define DEFINE(name, scaling)                                                 \
  void layer_convolve_##name(const layer_step_t* step, layer_share_t share) { \
    convolve(step, share, scaling);                                           \
  }

DEFINE(narrow, SCALING_NARROW)
DEFINE(wide, SCALING_WIDE)
DEFINE(exact, SCALING_EXACT)
DEFINE(none, SCALING_NONE)
