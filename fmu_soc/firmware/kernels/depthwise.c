// SPDX-License-Identifier: Apache-2.0
// Computes depthwise convolutions, four channels and four kernel positions at a time. A word is loaded for each
// position. The four words are transposed, so that each word contains the four values of one channel.
#include "kernels/requantise.h"
#include "kernels/work.h"

// Transpose of four words: for each channel, the values at four positions.
typedef struct {
  uint32_t channel[4];
} turned_t;

#ifdef __riscv

#include "kernels/dot.h"

static inline __attribute__((always_inline)) uint32_t word_at(const uint8_t* at) {
  return *(const xpulp_word*)(const void*)at;
}

static inline __attribute__((always_inline)) turned_t turn(uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
  // In a selector, 0 to 3 are the bytes of the first word, and 4 to 7 are the bytes of the second word.
  const uint32_t lower_ab = xpulp_shuffle2_b(a, b, 0x05010400);
  const uint32_t upper_ab = xpulp_shuffle2_b(a, b, 0x07030602);
  const uint32_t lower_cd = xpulp_shuffle2_b(c, d, 0x05010400);
  const uint32_t upper_cd = xpulp_shuffle2_b(c, d, 0x07030602);
  const turned_t result = {{xpulp_pack(lower_cd, lower_ab), xpulp_shuffle2_h(lower_ab, lower_cd, 0x00030001),
                            xpulp_pack(upper_cd, upper_ab), xpulp_shuffle2_h(upper_ab, upper_cd, 0x00030001)}};
  return result;
}

static inline __attribute__((always_inline)) int32_t add_products(int32_t sum, uint32_t values, const int8_t* weights) {
  return xpulp_sdotusp_b(sum, values, *(const uint32_t*)(const void*)weights);
}

#else

static uint32_t word_of(uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
  return (a & 0xff) | (b & 0xff) << 8 | (c & 0xff) << 16 | (d & 0xff) << 24;
}

static uint32_t word_at(const uint8_t* at) {
  return word_of(at[0], at[1], at[2], at[3]);
}

static turned_t turn(uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
  turned_t result;
  for (int i = 0; i < 4; ++i) {
    result.channel[i] = word_of(a >> 8 * i, b >> 8 * i, c >> 8 * i, d >> 8 * i);
  }
  return result;
}

static int32_t add_products(int32_t sum, uint32_t values, const int8_t* weights) {
  for (int i = 0; i < 4; ++i) {
    sum += (int32_t)(values >> 8 * i & 0xff) * weights[i];
  }
  return sum;
}

#endif

// Adds the products of values and weights at four positions of the kernel to the sums of four channels.
static inline __attribute__((always_inline)) void add_four(int32_t sums[4], const uint8_t* patch,
                                                           const int32_t* offsets, const int8_t* weights) {
  const turned_t values = turn(word_at(patch + offsets[0]), word_at(patch + offsets[1]), word_at(patch + offsets[2]),
                               word_at(patch + offsets[3]));
#pragma GCC unroll 4
  for (int i = 0; i < 4; ++i) {
    sums[i] = add_products(sums[i], values.channel[i], weights + 4 * i);
  }
}

// Computes the offset in a patch for each position of the kernel. Four positions are a group. To fill the last group,
// the last offset is repeated; the weights there are zero.
static void fill_offsets(const layer_step_t* step, int32_t* offsets) {
  const layer_t* layer = step->layer;
  int32_t count = 0;
  int32_t last = 0;
  for (int32_t y = 0; y < layer->runs_y; ++y) {
    for (int32_t x = 0; x < layer->runs_x; ++x) {
      last = y * layer->step_y * step->in_pitch + x * layer->step_x * step->in_channels;
      offsets[count++] = last;
    }
  }
  while (count < 4 * layer->run_words) {
    offsets[count++] = last;
  }
}

static inline __attribute__((always_inline)) void row_of_places(const layer_step_t* step, const layer_group_t* group,
                                                                const int32_t* offsets, const uint8_t* patch,
                                                                uint8_t* to, int32_t columns, int scaling) {
  const layer_t* layer = step->layer;
  const int32_t to_next = layer->stride_columns * step->in_channels;
  const int32_t channels = step->channels;
  const int32_t fours = layer->run_words;
  const int8_t* weights = weights_of(group, scaling);
  for (int32_t x = columns; x > 0; --x, patch += to_next, to += channels) {
    int32_t sums[4] = {group->bias[0], group->bias[1], group->bias[2], group->bias[3]};
    const int8_t* w = weights;
    const int32_t* at = offsets;
    for (int32_t i = fours; i > 0; --i, w += 16, at += 4) {
      add_four(sums, patch, at, w);
    }
    store_places(layer, group, sums, to, channels, 1, scaling);
  }
}

static inline __attribute__((always_inline)) void convolve(const layer_step_t* step, layer_share_t share, int scaling) {
  const layer_t* layer = step->layer;
  const int32_t columns = layer->out_columns;
  int32_t* offsets = (int32_t*)(void*)step->gathered;
  fill_offsets(step, offsets);
  // A unit of work is four channels of one row of output positions.
  for (int32_t unit = share.core; unit < step->groups * step->rows; unit += share.cores) {
    const int32_t y = unit / step->groups;
    const int32_t number = unit - y * step->groups;
    const layer_group_t* group = (const layer_group_t*)(const void*)(step->data + number * layer->group_bytes);
    const uint8_t* patch = step->in + y * layer->stride_rows * step->in_pitch + group->in;
    uint8_t* to = step->out + y * columns * step->channels + group->out;
    row_of_places(step, group, offsets, patch, to, columns, scaling);
  }
}

#define DEFINE(name, scaling)                                                  \
  void layer_depthwise_##name(const layer_step_t* step, layer_share_t share) { \
    convolve(step, share, scaling);                                            \
  }

DEFINE(narrow, SCALING_NARROW)
DEFINE(wide, SCALING_WIDE)
DEFINE(exact, SCALING_EXACT)
