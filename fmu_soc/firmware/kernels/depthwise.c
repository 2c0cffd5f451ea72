// SPDX-License-Identifier: Apache-2.0
// Computes depthwise convolutions, four channels at a time. The places of the kernel are processed in groups of
// four: a word is loaded from each, and transposed so that a word contains the four values of a channel.
#include "kernels/requantise.h"
#include "kernels/work.h"

#ifdef __riscv

#include "kernels/dot.h"

typedef struct {
  uint32_t channel[4];
} turned_t;

static inline __attribute__((always_inline)) uint32_t word_at(const uint8_t* at) {
  return *(const xpulp_word*)(const void*)at;
}

static inline __attribute__((always_inline)) turned_t turn(uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
  // The selectors: bytes of the first word are 0 to 3, bytes of the second 4 to 7.
  const uint32_t lower_ab = xpulp_shuffle2_b(a, b, 0x05010400);
  const uint32_t upper_ab = xpulp_shuffle2_b(a, b, 0x07030602);
  const uint32_t lower_cd = xpulp_shuffle2_b(c, d, 0x05010400);
  const uint32_t upper_cd = xpulp_shuffle2_b(c, d, 0x07030602);
  const turned_t result = {{xpulp_pack(lower_cd, lower_ab), xpulp_shuffle2_h(lower_ab, lower_cd, 0x00030001),
                            xpulp_pack(upper_cd, upper_ab), xpulp_shuffle2_h(upper_ab, upper_cd, 0x00030001)}};
  return result;
}

static inline __attribute__((always_inline)) void add_turned(int32_t sums[4], const turned_t* values,
                                                             const int8_t* weights) {
  const uint32_t* words = (const uint32_t*)(const void*)weights;
#pragma GCC unroll 4
  for (int i = 0; i < 4; ++i) {
    sums[i] = xpulp_sdotusp_b(sums[i], values->channel[i], words[i]);
  }
}

static inline __attribute__((always_inline)) void add_four(int32_t sums[4], const uint8_t* patch,
                                                           const int32_t* offsets, const int8_t* weights) {
  const turned_t values = turn(word_at(patch + offsets[0]), word_at(patch + offsets[1]), word_at(patch + offsets[2]),
                               word_at(patch + offsets[3]));
  add_turned(sums, &values, weights);
}

// Returns the next column of three rows; the weight of a word's fourth byte is zero.
static inline __attribute__((always_inline)) turned_t turned_column(const uint8_t* rows[3], int32_t to_next) {
  const uint32_t a = word_at(rows[0]), b = word_at(rows[1]), c = word_at(rows[2]);
  rows[0] += to_next, rows[1] += to_next, rows[2] += to_next;
  return turn(a, b, c, c);
}

#else

static void add_four(int32_t sums[4], const uint8_t* patch, const int32_t* offsets, const int8_t* weights) {
  for (int channel = 0; channel < 4; ++channel) {
    for (int i = 0; i < 4; ++i) {
      sums[channel] += patch[offsets[i] + channel] * weights[4 * channel + i];
    }
  }
}

#endif

// Fills the offsets of the kernel's places in a patch; the last one is repeated, with zeros as weights.
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
    int32_t sums[8] = {group->bias[0], group->bias[1], group->bias[2], group->bias[3]};
    const int8_t* w = weights;
    const int32_t* at = offsets;
    for (int32_t i = fours; i > 0; --i, w += 16, at += 4) {
      add_four(sums, patch, at, w);
    }
    store_places(layer, group, sums, to, channels, 0, scaling);
  }
}

// Computes a row of places of a 3 x 3 kernel with a stride of one column. Each word has the three values of a column,
// so two of three words are those of the previous place.
static inline __attribute__((always_inline)) void row_of_columns(const layer_step_t* step, const layer_group_t* group,
                                                                 const uint8_t* patch, uint8_t* to, int32_t columns,
                                                                 int scaling) {
  const layer_t* layer = step->layer;
  const int32_t channels = step->channels;
  const int32_t next_row = layer->step_y * step->in_pitch;
  const int8_t* weights = weights_of(group, scaling);
#ifdef __riscv
  const uint8_t* rows[3] = {patch, patch + next_row, patch + 2 * next_row};
  turned_t first = turned_column(rows, step->in_channels);
  turned_t second = turned_column(rows, step->in_channels);
  for (int32_t x = columns; x > 0; --x, to += channels) {
    const turned_t third = turned_column(rows, step->in_channels);
    int32_t sums[8] = {group->bias[0], group->bias[1], group->bias[2], group->bias[3]};
    add_turned(sums, &first, weights);
    add_turned(sums, &second, weights + 16);
    add_turned(sums, &third, weights + 32);
    first = second;
    second = third;
    store_places(layer, group, sums, to, channels, 0, scaling);
  }
#else
  for (int32_t x = columns; x > 0; --x, patch += step->in_channels, to += channels) {
    int32_t sums[8] = {group->bias[0], group->bias[1], group->bias[2], group->bias[3]};
    for (int32_t i = 0; i < 3; ++i) {
      const int32_t at = i * step->in_channels;
      const int32_t offsets[4] = {at, at + next_row, at + 2 * next_row, at + 2 * next_row};
      add_four(sums, patch, offsets, weights + 16 * i);
    }
    store_places(layer, group, sums, to, channels, 0, scaling);
  }
#endif
}

static inline __attribute__((always_inline)) void convolve(const layer_step_t* step, layer_share_t share,
                                                           int by_columns, int scaling) {
  const layer_t* layer = step->layer;
  const int32_t columns = layer->out_columns;
  int32_t* offsets = (int32_t*)(void*)step->gathered;
  if (!by_columns) {
    fill_offsets(step, offsets);
  }
  // A unit of work is four channels of one row of places.
  for (int32_t unit = share.core; unit < step->groups * step->rows; unit += share.cores) {
    const int32_t y = unit / step->groups;
    const int32_t number = unit - y * step->groups;
    const layer_group_t* group = (const layer_group_t*)(const void*)(step->data + number * layer->group_bytes);
    const uint8_t* patch = step->in + y * layer->stride_rows * step->in_pitch + group->in;
    uint8_t* to = step->out + y * columns * step->channels + group->out;
    if (by_columns) {
      row_of_columns(step, group, patch, to, columns, scaling);
    } else {
      row_of_places(step, group, offsets, patch, to, columns, scaling);
    }
  }
}

#define DEFINE(name, scaling)                                                          \
  void layer_depthwise_##name(const layer_step_t* step, layer_share_t share) {         \
    convolve(step, share, 0, scaling);                                                 \
  }                                                                                    \
  void layer_depthwise_columns_##name(const layer_step_t* step, layer_share_t share) { \
    convolve(step, share, 1, scaling);                                                 \
  }

DEFINE(narrow, SCALING_NARROW)
DEFINE(wide, SCALING_WIDE)
DEFINE(exact, SCALING_EXACT)
