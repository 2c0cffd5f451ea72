// SPDX-License-Identifier: Apache-2.0
// Converts the sums of four channels to bytes.
#pragma once

#include "kernels/layer.h"

#ifdef __riscv
#include "kernels/dot.h"
#endif

static inline __attribute__((always_inline)) int32_t upper_product(int32_t a, int32_t b) {
#ifdef __riscv
  int32_t result;  // in C, the compiler would use several multiplications
  __asm__("mulh %0, %1, %2" : "=r"(result) : "r"(a), "r"(b));
  return result;
#else
  return (int32_t)(((int64_t)a * b) >> 32);
#endif
}

// Converts a sum to a value before clipping. For speed, `wide` should be a constant.
static inline __attribute__((always_inline)) int32_t scaled(int32_t sum, int32_t multiplier, int32_t addend,
                                                            int32_t shift, int wide) {
  const int32_t product = wide ? upper_product(sum, multiplier) : sum * multiplier;
#ifdef __riscv
  return xpulp_addNr(product, (uint32_t)addend, (uint32_t)shift);
#else
  return (product + addend) >> shift;
#endif
}

static inline __attribute__((always_inline)) int32_t limited(int32_t value, int32_t low, int32_t high) {
#ifdef __riscv
  return xpulp_min(xpulp_max(value, low), high);
#else
  return value < low ? low : value > high ? high : value;
#endif
}

static inline __attribute__((always_inline)) const int8_t* weights_of(const layer_group_t* group, int scaling) {
  return (const int8_t*)(group + 1) + (scaling == SCALING_EXACT ? 16 : 0);
}

static inline __attribute__((always_inline)) void store_four(uint8_t* to, const int32_t bytes[4]) {
#ifdef __riscv
  *(xpulp_word*)(void*)to = pack_bytes(bytes[0], bytes[1], bytes[2], bytes[3]);
#else
  for (int i = 0; i < 4; ++i) {
    to[i] = (uint8_t)bytes[i];
  }
#endif
}

// Returns the lower word of an addend, or 0 if the addend has one word.
static inline __attribute__((always_inline)) uint32_t lower_addend(const layer_group_t* group, int i, int scaling) {
  return scaling == SCALING_EXACT ? ((const uint32_t*)(const void*)(group + 1))[i] : 0;
}

// Converts a sum of channel `i` to a value before clipping. `lower` is the lower word of the addend.
static inline __attribute__((always_inline)) int32_t byte_of(const layer_group_t* group, uint32_t lower, int i,
                                                             int32_t sum, int scaling) {
  if (scaling == SCALING_EXACT) {
    const int64_t addend = (int64_t)((uint64_t)(uint32_t)group->addend[i] << 32 | lower);
    return (int32_t)(((int64_t)sum * group->multiplier[i] + addend) >> 32) >> group->shift[i];
  }
  return scaled(sum, group->multiplier[i], group->addend[i], group->shift[i], scaling == SCALING_WIDE);
}

// Stores the bytes of four channels for `count` output positions, which are `to_next` bytes apart.
static inline __attribute__((always_inline)) void store_places(const layer_t* layer, const layer_group_t* group,
                                                               const int32_t* sums, uint8_t* to, int32_t to_next,
                                                               int32_t count, int scaling) {
  const int32_t low = layer->low, high = layer->high;
  const layer_group_t own = *group;
  for (; count > 0; --count, sums += 4, to += to_next) {
    if (scaling == SCALING_NONE) {
      for (int32_t i = 0; i < own.count; ++i) {
        ((int32_t*)(void*)to)[i] = sums[i];
      }
      continue;
    }
    int32_t bytes[4];
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) {
      bytes[i] = limited(byte_of(&own, lower_addend(group, i, scaling), i, sums[i], scaling), low, high);
    }
    if (own.count == 4) {
      store_four(to, bytes);
      continue;
    }
    for (int32_t i = 0; i < own.count; ++i) {
      to[i] = (uint8_t)bytes[i];
    }
  }
}
