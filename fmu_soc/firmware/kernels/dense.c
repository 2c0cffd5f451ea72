// SPDX-License-Identifier: Apache-2.0
// Dense layers: convolutions with one output position, whose patch is contiguous. Each core computes the same number of
// products. Several cores may share the products of a group of four channels. Then the core that computes the first
// products of the group adds the partial sums of the other cores, and stores the outputs.
#include "kernels/machine.h"
#include "kernels/requantise.h"
#include "kernels/work.h"

// Multiplies `words` words of the patch by the weights of four channels, and adds the products to `sums`.
static inline __attribute__((always_inline)) void add_words(int32_t sums[4], const uint8_t* p0, const int8_t* w,
                                                            int32_t words) {
  int32_t a0 = sums[0], a1 = sums[1], a2 = sums[2], a3 = sums[3];
#ifdef __riscv
  INTERLEAVED_ROW_OF_ONE_PATCH;
#else
  for (int32_t i = 0; i < 4 * words; ++i) {
    const int8_t* of_first = w + i / 4 * 16 + i % 4;
    a0 += p0[i] * of_first[0], a1 += p0[i] * of_first[4], a2 += p0[i] * of_first[8], a3 += p0[i] * of_first[12];
  }
#endif
  sums[0] = a0, sums[1] = a1, sums[2] = a2, sums[3] = a3;
}

static inline __attribute__((always_inline)) void store_group(const layer_step_t* step, const layer_group_t* group,
                                                              int32_t number, const int32_t sums[4], int scaling) {
  store_places(step->layer, group, sums, step->out + 4 * number * step->layer->element, 0, 1, scaling);
}

// Adds to `sums` the partial sums of the cores after `core` that computed products of the same group. Each core
// computed `each` words, and the group ends at word `end` of the step.
static void add_partials(const layer_step_t* step, int32_t core, int32_t each, int32_t end, int32_t sums[4]) {
  const uint8_t* partial = step->gathered;
  while (++core * each < end) {
    partial += step->layer->gathered_stride;
    for (int i = 0; i < 4; ++i) {
      sums[i] += ((const int32_t*)(const void*)partial)[i];
    }
  }
}

static inline __attribute__((always_inline)) void compute(const layer_step_t* step, layer_share_t share, int scaling) {
  const layer_t* layer = step->layer;
  const int32_t words = layer->run_words;
  const int32_t total = step->groups * words;
  const int32_t each = (total + share.cores - 1) / share.cores;
  int32_t at = smaller(share.core * each, total);
  const int32_t end = smaller(at + each, total);
  int32_t number = at / words;
  int32_t word = at - number * words;
  const layer_group_t* group = (const layer_group_t*)(const void*)(step->data + number * layer->group_bytes);
  int32_t* partial = (int32_t*)(void*)step->gathered;  // of a group whose first products another core computes
  int is_begun = 0;                                    // true if other cores compute the last products of `group`
  int32_t sums[4];
  while (at < end) {
    const int32_t count = smaller(words - word, end - at);
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) {
      sums[i] = word == 0 ? group->bias[i] : 0;
    }
    add_words(sums, step->in + 4 * word, weights_of(group, scaling) + 16 * word, count);
    at += count;
    if (count == words) {
      store_group(step, group, number, sums, scaling);
    } else if (word > 0) {
      partial[0] = sums[0], partial[1] = sums[1], partial[2] = sums[2], partial[3] = sums[3];
    } else {
      is_begun = 1;
      break;
    }
    word = 0;
    ++number;
    group = (const layer_group_t*)(const void*)((const uint8_t*)group + layer->group_bytes);
  }
  if (each % words == 0) {
    return;  // each group belongs to a single core
  }
  machine_barrier();
  if (is_begun) {
    add_partials(step, share.core, each, (number + 1) * words, sums);
    store_group(step, group, number, sums, scaling);
  }
}

#define DEFINE(name, scaling)                                              \
  void layer_dense_##name(const layer_step_t* step, layer_share_t share) { \
    compute(step, share, scaling);                                         \
  }

DEFINE(narrow, SCALING_NARROW)
DEFINE(wide, SCALING_WIDE)
DEFINE(exact, SCALING_EXACT)
DEFINE(none, SCALING_NONE)
