// SPDX-License-Identifier: Apache-2.0
// Between steps.c, which moves tiles, and the kernels, which compute them.
#pragma once

#include "kernels/layer.h"

#ifdef __riscv
#include "runtime/xpulp.h"
#endif

// A step: a block of channels of a tile of rows, with its buffers in L1.
typedef struct {
  const layer_t* layer;
  const uint8_t* in;
  const uint8_t* other;
  const uint8_t* data;
  uint8_t* out;
  uint8_t* unpooled;
  uint8_t* gathered;    // the core's own buffer
  int32_t rows;         // of the output
  int32_t channels;     // of the output
  int32_t groups;       // of a convolution
  int32_t in_channels;  // of a place of the input in L1
  int32_t in_pitch;     // bytes from row to row of the input in L1
  int32_t first_row;    // of the output
} layer_step_t;

// Returns the upper word of the product.
static inline __attribute__((always_inline)) int32_t upper_product(int32_t a, int32_t b) {
#ifdef __riscv
  int32_t result;  // the compiler would take several multiplications
  __asm__("mulh %0, %1, %2" : "=r"(result) : "r"(a), "r"(b));
  return result;
#else
  return (int32_t)(((int64_t)a * b) >> 32);
#endif
}

// Converts a sum into the value of a byte, before its limits. `wide` should be a constant.
static inline __attribute__((always_inline)) int32_t scaled(int32_t sum, int32_t multiplier, int32_t addend,
                                                            int32_t shift, int wide) {
  return ((wide ? upper_product(sum, multiplier) : sum * multiplier) + addend) >> shift;
}

static inline __attribute__((always_inline)) int32_t limited(int32_t value, int32_t low, int32_t high) {
#ifdef __riscv
  return xpulp_min(xpulp_max(value, low), high);
#else
  return value < low ? low : value > high ? high : value;
#endif
}

void layer_convolve(const layer_step_t* step, layer_share_t share);
void layer_max_pool(const layer_step_t* step, layer_share_t share);
void layer_average_pool(const layer_step_t* step, layer_share_t share);
void layer_add(const layer_step_t* step, layer_share_t share);
void layer_multiply(const layer_step_t* step, layer_share_t share);
void layer_table(const layer_step_t* step, layer_share_t share);

// These two access the network's memory directly.
void layer_move(const layer_move_t* move, const uint8_t* in, uint8_t* out, layer_share_t share);
void layer_softmax(const layer_t* layer, const uint32_t* powers, const uint8_t* in, uint8_t* out, layer_share_t share);
