// SPDX-License-Identifier: Apache-2.0
// Convolutions with any kernel, stride, dilation and groups, and dense layers, which are convolutions with one output
// position.
#include "kernels/products.h"
#include "kernels/requantise.h"
#include "kernels/work.h"

static inline __attribute__((always_inline)) void row_of_places(const layer_t* layer, const layer_group_t* group,
                                                                const uint8_t* patch, int32_t to_next, uint8_t* to,
                                                                int32_t columns, int32_t channels, int scaling) {
  int32_t sums[8];
  for (; columns > 1; columns -= 2, patch += 2 * to_next, to += 2 * channels) {
    add_products(layer, group, patch, to_next, sums, 1, 0, scaling);
    store_places(layer, group, sums, to, channels, 1, scaling);
  }
  if (columns > 0) {
    add_products(layer, group, patch, to_next, sums, 0, 0, scaling);
    store_places(layer, group, sums, to, channels, 0, scaling);
  }
}

static inline __attribute__((always_inline)) void all_groups(const layer_step_t* step, uint8_t* to, int is_pair,
                                                             int scaling) {
  const layer_t* layer = step->layer;
  const uint8_t* data = step->data;
  const int32_t channels = step->channels * layer->element;
  int32_t sums[8];
  for (int32_t i = step->groups; i > 0; --i, data += layer->group_bytes) {
    const layer_group_t* group = (const layer_group_t*)(const void*)data;
    add_products(layer, group, step->gathered, layer->gathered_bytes, sums, is_pair, 1, scaling);
    store_places(layer, group, sums, to + group->out * layer->element, channels, is_pair, scaling);
  }
}

// Computes a convolution whose patches consist of short runs of bytes. First copies the patches of two output positions
// to contiguous bytes, and then uses these bytes for all channels.
static inline __attribute__((always_inline)) void convolve_gathered(const layer_step_t* step, layer_share_t share,
                                                                    int scaling) {
  const layer_t* layer = step->layer;
  const int32_t rows = step->rows * layer->pool;
  const int32_t columns = layer->out_columns * layer->pool;
  uint8_t* out = layer->then != 0 ? step->unpooled : step->out;
  const int32_t to_next = layer->stride_columns * step->in_channels;
  const int32_t pairs = (columns + 1) / 2;
  for (int32_t unit = share.core; unit < rows * pairs; unit += share.cores) {
    const int32_t y = unit / pairs;
    const int32_t x = 2 * (unit - y * pairs);
    const uint8_t* patch = step->in + y * layer->stride_rows * step->in_pitch + x * to_next;
    uint8_t* to = out + (y * columns + x) * step->channels * layer->element;
    gather(layer, patch, step->gathered);
    if (x + 1 < columns) {
      gather(layer, patch + to_next, step->gathered + layer->gathered_bytes);
      all_groups(step, to, 1, scaling);
    } else {
      all_groups(step, to, 0, scaling);
    }
  }
}

static inline __attribute__((always_inline)) void convolve_in_place(const layer_step_t* step, layer_share_t share,
                                                                    int scaling) {
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

#define DEFINE(name, scaling)                                                          \
  void layer_convolve_##name(const layer_step_t* step, layer_share_t share) {          \
    convolve_in_place(step, share, scaling);                                           \
  }                                                                                    \
  void layer_convolve_gathered_##name(const layer_step_t* step, layer_share_t share) { \
    convolve_gathered(step, share, scaling);                                           \
  }

DEFINE(narrow, SCALING_NARROW)
DEFINE(wide, SCALING_WIDE)
DEFINE(exact, SCALING_EXACT)
DEFINE(none, SCALING_NONE)
