// SPDX-License-Identifier: Apache-2.0
// Convolutions with any kernel, stride, dilation and groups, and dense layers, which are convolutions of one place.
#include "kernels/machine.h"
#include "kernels/requantise.h"
#include "kernels/work.h"

#ifdef __riscv

#include "kernels/dot.h"

// Adds the products of a patch for one or two places and four channels.
static inline __attribute__((always_inline)) void add_products(const layer_t* layer, const layer_group_t* group,
                                                               const uint8_t* p0, int32_t to_next, int32_t sums[8],
                                                               int is_pair, int is_one_run, int scaling) {
  const int words = layer->run_words;
  const int32_t channel = (is_one_run ? 1 : layer->runs_y * layer->runs_x) * words * 4;
  const int8_t* w0 = weights_of(group, scaling);
  const int8_t* w1 = w0 + channel;
  const int8_t* w2 = w1 + channel;
  const int8_t* w3 = w2 + channel;
  const uint8_t* p1 = p0 + to_next;
  int32_t a0 = group->bias[0], a1 = group->bias[1], a2 = group->bias[2], a3 = group->bias[3];
  int32_t b0 = a0, b1 = a1, b2 = a2, b3 = a3;
  for (int32_t y = is_one_run ? 1 : layer->runs_y; y > 0; --y) {
    for (int32_t x = is_one_run ? 1 : layer->runs_x; x > 0; --x) {
      if (is_pair) {
        ROW_OF_PATCH;
        p1 += layer->step_x;
      } else {
        ROW_OF_ONE_PATCH;
      }
      p0 += layer->step_x;
    }
    p0 += layer->step_y;
    p1 += layer->step_y;
  }
  sums[0] = a0, sums[1] = a1, sums[2] = a2, sums[3] = a3;
  sums[4] = b0, sums[5] = b1, sums[6] = b2, sums[7] = b3;
}

static inline __attribute__((always_inline)) void copy_four(uint8_t* to, const uint8_t* from) {
  *(xpulp_word*)(void*)to = *(const xpulp_word*)(const void*)from;
}

#else

#include <string.h>

static void add_products(const layer_t* layer, const layer_group_t* group, const uint8_t* p0, int32_t to_next,
                         int32_t sums[8], int is_pair, int is_one_run, int scaling) {
  (void)is_one_run;
  const int32_t run = layer->run_words * 4;
  const int8_t* weight = weights_of(group, scaling);
  for (int place = 0; place <= is_pair; ++place) {
    const int8_t* w = weight;
    for (int channel = 0; channel < 4; ++channel) {
      const uint8_t* p = p0 + place * to_next;
      int32_t sum = group->bias[channel];
      for (int32_t y = 0; y < layer->runs_y; ++y, p += layer->step_y) {
        for (int32_t x = 0; x < layer->runs_x; ++x, p += layer->step_x) {
          for (int32_t i = 0; i < run; ++i) {
            sum += *p++ * *w++;
          }
        }
      }
      sums[4 * place + channel] = sum;
    }
  }
}

static void copy_four(uint8_t* to, const uint8_t* from) {
  memcpy(to, from, 4);
}

#endif

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

// Copies a patch to contiguous bytes. Words may exceed a run; the next run then replaces what is too much.
static void gather(const layer_t* layer, const uint8_t* patch, uint8_t* to) {
  const int32_t bytes = layer->gather_bytes;
  const int32_t step = layer->gather_row_step;
  if (layer->gather_runs == 1 && bytes <= 8) {
    for (int32_t y = layer->gather_rows; y > 0; --y, patch += step, to += bytes) {
      copy_four(to, patch);
      copy_four(to + 4, patch + 4);
    }
    return;
  }
  for (int32_t y = 0; y < layer->gather_rows; ++y, patch += step) {
    const uint8_t* run = patch;
    for (int32_t x = 0; x < layer->gather_runs; ++x, run += layer->gather_step, to += bytes) {
      for (int32_t i = 0; i < bytes; i += 4) {
        copy_four(to + i, run + i);
      }
    }
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

// Short runs of bytes: the patches of two places are gathered for all channels.
static void convolve_gathered(const layer_step_t* step, uint8_t* out, int32_t rows, int32_t columns,
                              layer_share_t share) {
  const layer_t* layer = step->layer;
  const int32_t to_next = layer->stride_columns * step->in_channels;
  const int32_t pairs = (columns + 1) / 2;
  for (int32_t unit = share.core; unit < rows * pairs; unit += share.cores) {
    const int32_t y = unit / pairs;
    const int32_t x = 2 * (unit - y * pairs);
    const uint8_t* patch = step->in + y * layer->stride_rows * step->in_pitch + x * to_next;
    uint8_t* to = out + (y * columns + x) * step->channels * layer->element;
    const int is_pair = x + 1 < columns;
    gather(layer, patch, step->gathered);
    if (is_pair) {
      gather(layer, patch + to_next, step->gathered + layer->gathered_bytes);
    }
    if (is_pair && layer->scaling == SCALING_WIDE) {
      all_groups(step, to, 1, SCALING_WIDE);
    } else if (is_pair && layer->scaling == SCALING_NARROW) {
      all_groups(step, to, 1, SCALING_NARROW);
    } else {
      all_groups(step, to, is_pair, layer->scaling);
    }
  }
}

static void convolve_in_place(const layer_step_t* step, uint8_t* out, int32_t rows, int32_t columns,
                              layer_share_t share) {
  const layer_t* layer = step->layer;
  const int32_t to_next = layer->stride_columns * step->in_channels;
  // A unit of work is a row of places by four output channels.
  for (int32_t unit = share.core; unit < step->groups * rows; unit += share.cores) {
    const int32_t y = unit / step->groups;
    const int32_t number = unit - y * step->groups;
    const layer_group_t* group = (const layer_group_t*)(const void*)(step->data + number * layer->group_bytes);
    const uint8_t* patch = step->in + y * layer->stride_rows * step->in_pitch + group->in;
    const int32_t channels = step->channels * layer->element;
    uint8_t* to = out + y * columns * channels + group->out * layer->element;
    if (layer->scaling == SCALING_WIDE) {
      row_of_places(layer, group, patch, to_next, to, columns, channels, SCALING_WIDE);
    } else if (layer->scaling == SCALING_NARROW) {
      row_of_places(layer, group, patch, to_next, to, columns, channels, SCALING_NARROW);
    } else {
      row_of_places(layer, group, patch, to_next, to, columns, channels, layer->scaling);
    }
  }
}

void layer_convolve(const layer_step_t* step, layer_share_t share) {
  const layer_t* layer = step->layer;
  const int32_t rows = step->rows * layer->pool;
  const int32_t columns = layer->out_columns * layer->pool;
  uint8_t* out = layer->pool > 1 ? step->unpooled : step->out;
  if (layer->gather_runs > 0) {
    convolve_gathered(step, out, rows, columns, share);
  } else {
    convolve_in_place(step, out, rows, columns, share);
  }
  if (layer->pool > 1) {
    machine_barrier();
    layer_max_pool(step, share);
  }
}
