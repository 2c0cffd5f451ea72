// SPDX-License-Identifier: Apache-2.0
// Controls the cluster's DMA through MCHAN's registers. A copy is identified by its counter.
#include <stdbool.h>

#include "runtime/cluster.h"
#include "runtime/registers.h"

#define DMA_OUT 0u
#define DMA_IN (UINT32_C(1) << 16)
#define INCREMENTS (UINT32_C(1) << 17)
#define IN_ROWS (UINT32_C(1) << 18)
#define RAISES_EVENT (UINT32_C(1) << 19)
#define MOST_BYTES 0xFFFFu
#define MOST_ROW 0x7FFFu
#define STRIDE_SHIFT 16
#define TAKEN_SHIFT 16
#define ALL_TAKEN 0xFFFFu
#define COUNTERS 16
#define FABRIC_CONTROLLER 32u  // higher numbers belong to cores of other clusters

static bool is_core(void) {
  uint32_t id;
  __asm__("csrr %0, mhartid" : "=r"(id));
  return id < FABRIC_CONTROLLER;
}

static inline __attribute__((always_inline)) bool fits(uint32_t l1, uint32_t l2, uint32_t bytes, uint32_t row,
                                                       uint32_t stride) {
  const uint32_t rows = row == 0 ? 1 : bytes / row;
  const uint32_t span = row == 0 ? bytes : (rows - 1) * stride + row;
  const bool in_l1 = l1 - L1_BASE < L1_SIZE && bytes <= L1_SIZE - (l1 - L1_BASE);
  const bool outside = (l2 - L2_BASE < L2_SIZE && span <= L2_SIZE - (l2 - L2_BASE)) ||
                       (l2 - FC_TCDM_BASE < FC_TCDM_SIZE && span <= FC_TCDM_SIZE - (l2 - FC_TCDM_BASE));
  return bytes > 0 && bytes <= MOST_BYTES && rows * (row == 0 ? bytes : row) == bytes && row <= MOST_ROW &&
         stride <= MOST_ROW && in_l1 && outside;
}

// Starts a copy. Inlined, because most callers pass row = 0: the compiler then removes the code for rows.
static inline __attribute__((always_inline)) uint32_t start(uint32_t direction, uint32_t l1, uint32_t l2,
                                                            uint32_t bytes, uint32_t row, uint32_t stride) {
  if (!fits(l1, l2, bytes, row, stride)) {
    return DMA_REFUSED;
  }
  const uint32_t dma = is_core() ? DMA_BASE : DMA_LONG_BASE;
  while (load(dma + DMA_STATUS_OFFSET) >> TAKEN_SHIFT == ALL_TAKEN) {
  }
  const uint32_t copy = load(dma + DMA_QUEUE_OFFSET);
  store(dma + DMA_QUEUE_OFFSET, bytes | direction | INCREMENTS | RAISES_EVENT | (row == 0 ? 0 : IN_ROWS));
  store(dma + DMA_QUEUE_OFFSET, l1);
  store(dma + DMA_QUEUE_OFFSET, l2);
  if (row != 0) {
    store(dma + DMA_QUEUE_OFFSET, stride << STRIDE_SHIFT | row);
  }
  return copy;
}

#include "runtime/dma_copies.h"

// Waits for the end of a copy. A cluster core sleeps, but the fabric controller polls, because it receives no event of
// the DMA.
void dma_wait(uint32_t copy) {
  if (copy >= COUNTERS) {  // DMA_REFUSED
    return;
  }
  const bool core = is_core();
  const uint32_t dma = core ? DMA_BASE : DMA_LONG_BASE;
  while ((load(dma + DMA_STATUS_OFFSET) >> copy & 1u) != 0) {
    if (core) {
      store(EU_BASE + EU_MASK_OFFSET, UINT32_C(1) << CLUSTER_EVENT_DMA);
      event_load(EU_BASE + EU_WAIT_CLEAR_OFFSET);
      store(EU_BASE + EU_MASK_OFFSET, UINT32_C(1) << CLUSTER_EVENT_BARRIER);
    }
  }
  store(dma + DMA_STATUS_OFFSET, UINT32_C(1) << copy);
}
