// SPDX-License-Identifier: Apache-2.0
// Convolutions followed by the maximum of 2 x 2 output positions. All multipliers are positive, so the greatest sum
// gives the greatest byte. Therefore the maximum is computed first, and only one of four sums is requantised.
#include "kernels/products.h"
#include "kernels/requantise.h"
#include "kernels/work.h"

static inline __attribute__((always_inline)) int32_t larger(int32_t a, int32_t b) {
#ifdef __riscv
  return xpulp_max(a, b);
#else
  return a > b ? a : b;
#endif
}

// Computes one pooled output position for four channels. The lower two patches are `to_lower` bytes after the upper
// two.
static inline __attribute__((always_inline)) void pooled_place(const layer_t* layer, const layer_group_t* group,
                                                               const uint8_t* patch, int32_t to_next, int32_t to_lower,
                                                               uint8_t* to, int is_one_run, int scaling) {
  int32_t sums[8];
  int32_t lower[8];
  add_products(layer, group, patch, to_next, sums, 1, is_one_run, scaling);
  add_products(layer, group, patch + to_lower, to_next, lower, 1, is_one_run, scaling);
#pragma GCC unroll 4
  for (int i = 0; i < 4; ++i) {
    sums[i] = larger(larger(sums[i], sums[4 + i]), larger(lower[i], lower[4 + i]));
  }
  store_places(layer, group, sums, to, 0, 0, scaling);
}

static inline __attribute__((always_inline)) void gathered_place(const layer_step_t* step, const uint8_t* patch,
                                                                 uint8_t* to, int scaling) {
  const layer_t* layer = step->layer;
  const int32_t to_next = layer->stride_columns * step->in_channels;
  const int32_t bytes = layer->gathered_bytes;
  const uint8_t* lower = patch + layer->stride_rows * step->in_pitch;
  gather(layer, patch, step->gathered);
  gather(layer, patch + to_next, step->gathered + bytes);
  gather(layer, lower, step->gathered + 2 * bytes);
  gather(layer, lower + to_next, step->gathered + 3 * bytes);
  const uint8_t* data = step->data;
  for (int32_t i = step->groups; i > 0; --i, data += layer->group_bytes) {
    const layer_group_t* group = (const layer_group_t*)(const void*)data;
    pooled_place(layer, group, step->gathered, bytes, 2 * bytes, to + group->out, 1, scaling);
  }
}

static inline __attribute__((always_inline)) void pooled_gathered(const layer_step_t* step, layer_share_t share,
                                                                  int scaling) {
  const layer_t* layer = step->layer;
  const int32_t columns = layer->out_columns;
  const int32_t to_next = layer->stride_columns * step->in_channels;
  const int32_t to_lower = layer->stride_rows * step->in_pitch;
  for (int32_t unit = share.core; unit < step->rows * columns; unit += share.cores) {
    const int32_t y = unit / columns;
    const int32_t x = unit - y * columns;
    gathered_place(step, step->in + 2 * (y * to_lower + x * to_next), step->out + unit * step->channels, scaling);
  }
}

static inline __attribute__((always_inline)) void pooled_in_place(const layer_step_t* step, layer_share_t share,
                                                                  int scaling) {
  const layer_t* layer = step->layer;
  const int32_t columns = layer->out_columns;
  const int32_t channels = step->channels;
  const int32_t to_next = layer->stride_columns * step->in_channels;
  const int32_t to_lower = layer->stride_rows * step->in_pitch;
  for (int32_t unit = share.core; unit < step->groups * step->rows; unit += share.cores) {
    const int32_t y = unit / step->groups;
    const int32_t number = unit - y * step->groups;
    const layer_group_t* group = (const layer_group_t*)(const void*)(step->data + number * layer->group_bytes);
    const uint8_t* patch = step->in + 2 * y * to_lower + group->in;
    uint8_t* to = step->out + y * columns * channels + group->out;
    for (int32_t x = columns; x > 0; --x, patch += 2 * to_next, to += channels) {
      pooled_place(layer, group, patch, to_next, to_lower, to, 0, scaling);
    }
  }
}

#define DEFINE(name, scaling)                                                                 \
  void layer_convolve_pooled_##name(const layer_step_t* step, layer_share_t share) {          \
    pooled_in_place(step, share, scaling);                                                    \
  }                                                                                           \
  void layer_convolve_gathered_pooled_##name(const layer_step_t* step, layer_share_t share) { \
    pooled_gathered(step, share, scaling);                                                    \
  }

DEFINE(narrow, SCALING_NARROW)
DEFINE(wide, SCALING_WIDE)
DEFINE(exact, SCALING_EXACT)
