// SPDX-License-Identifier: Apache-2.0
// Computes products of patches with the weights of four output channels.
#pragma once

#include "kernels/requantise.h"

#ifdef __riscv

// Computes the sums of four channels for one or two patches: the bias plus the products of values and weights.
static inline __attribute__((always_inline)) void add_products(const layer_t* layer, const layer_group_t* group,
                                                               const uint8_t* p0, int32_t to_next, int32_t sums[8],
                                                               int is_pair, int scaling) {
  const int words = layer->run_words;
  const int32_t channel = layer->runs_y * layer->runs_x * words * 4;
  const int8_t* w0 = weights_of(group, scaling);
  const int8_t* w1 = w0 + channel;
  const int8_t* w2 = w1 + channel;
  const int8_t* w3 = w2 + channel;
  const uint8_t* p1 = p0 + to_next;
  int32_t a0 = group->bias[0], a1 = group->bias[1], a2 = group->bias[2], a3 = group->bias[3];
  int32_t b0 = a0, b1 = a1, b2 = a2, b3 = a3;
  for (int32_t y = layer->runs_y; y > 0; --y) {
    for (int32_t x = layer->runs_x; x > 0; --x) {
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

#else

static inline void add_products(const layer_t* layer, const layer_group_t* group, const uint8_t* p0, int32_t to_next,
                                int32_t sums[8], int is_pair, int scaling) {
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

#endif
