// SPDX-License-Identifier: Apache-2.0
// Interface between steps.c, which transfers tiles, and the kernels, which compute them.
#pragma once

#include "kernels/layer.h"
#ifdef __riscv
#include "runtime/xpulp.h"
#endif

// A step of a layer computes a block of channels of a tile of rows. Its buffers are in L1.
struct layer_step {
  const layer_t* layer;
  const uint8_t* in;
  const uint8_t* other;
  const uint8_t* data;
  uint8_t* out;
  uint8_t* unpooled;
  uint8_t* gathered;    // buffer of this core
  int32_t rows;         // rows of the output
  int32_t channels;     // channels of the output
  int32_t groups;       // groups of channels in a convolution
  int32_t in_channels;  // channels of the input in L1
  int32_t in_pitch;     // bytes from row to row of the input in L1
  int32_t first_row;    // first row of the output
};

// These functions access the network's memory directly.
void layer_move(const layer_move_t* move, const uint8_t* in, uint8_t* out, layer_share_t share);
void layer_softmax(const layer_t* layer, const uint32_t* powers, const uint8_t* in, uint8_t* out, layer_share_t share);

static inline __attribute__((always_inline)) int32_t smaller(int32_t a, int32_t b) {
#ifdef __riscv
  return xpulp_min(a, b);
#else
  return a < b ? a : b;
#endif
}

// The units of work of a core: from `begin` to `end` - 1.
typedef struct {
  int32_t begin, end;
} range_t;

static inline __attribute__((always_inline)) int32_t larger(int32_t a, int32_t b) {
#ifdef __riscv
  return xpulp_max(a, b);
#else
  return a > b ? a : b;
#endif
}

// Divides `units` units of work evenly among the cores. Returns the part of the core `share.core`.
static inline __attribute__((always_inline)) range_t range_of(int32_t units, layer_share_t share) {
  const range_t range = {units * share.core / share.cores, units * (share.core + 1) / share.cores};
  return range;
}
