// SPDX-License-Identifier: Apache-2.0
// Declares the barrier and the DMA of the cluster. On other machines, one core computes all layers, and copies are
// immediate.
#pragma once

#include <stdint.h>

#ifdef __riscv

#include "runtime/cluster.h"
#include "runtime/xpulp.h"

#define machine_barrier() cluster_barrier()
#define machine_copy_in(to, from, bytes) dma_copy_in(to, from, bytes)
#define machine_copy_in_rows(to, from, bytes, row, stride) dma_copy_in_2d(to, from, bytes, row, stride)
#define machine_copy_out(to, from, bytes) dma_copy_out(to, from, bytes)
#define machine_copy_out_rows(to, from, bytes, row, stride) dma_copy_out_2d(to, from, bytes, row, stride)
#define machine_wait(copy) dma_wait(copy)

#else

#include <string.h>

#define machine_barrier() ((void)0)
#define machine_wait(copy) ((void)(copy))

static inline uint32_t machine_copy_in(void* to, const void* from, uint32_t bytes) {
  memcpy(to, from, bytes);
  return 0;
}

static inline uint32_t machine_copy_in_rows(void* to, const void* from, uint32_t bytes, uint32_t row, uint32_t stride) {
  for (uint32_t at = 0; at < bytes; at += row) {
    memcpy((uint8_t*)to + at, (const uint8_t*)from + at / row * stride, row);
  }
  return 0;
}

static inline uint32_t machine_copy_out(void* to, const void* from, uint32_t bytes) {
  memcpy(to, from, bytes);
  return 0;
}

static inline uint32_t machine_copy_out_rows(void* to, const void* from, uint32_t bytes, uint32_t row,
                                             uint32_t stride) {
  for (uint32_t at = 0; at < bytes; at += row) {
    memcpy((uint8_t*)to + at / row * stride, (const uint8_t*)from + at, row);
  }
  return 0;
}

#endif
