// SPDX-License-Identifier: Apache-2.0
#include "runtime/cluster.h"

#include "board.h"

#define EVENT_DMA (UINT32_C(1) << 8)
#define EVENT_JOB (UINT32_C(1) << 17)
#define DMA_IN 1u
#define DMA_OUT 2u
#define DMA_STATUS_REFUSED (UINT32_C(1) << 31)
#define DMA_ALL_IN_USE 0xffffu
#define POWER_REFUSED 1u

void cluster_start(void);

// Waits for one of `events`, and clears this event. Other events stay in the buffer.
static void wait_for(uint32_t events) {
  EVENT_UNIT_EVENT_MASK = events;
  event_load(EVENT_UNIT_BASE + EVENT_UNIT_EVENT_WAIT_OFFSET);
  EVENT_UNIT_EVENT_MASK = 0;
}

// Returns 0 if the last request was granted, otherwise -1.
static int granted(void) {
  const uint32_t status = POWER_MANAGER_STATUS;
  POWER_MANAGER_STATUS = POWER_REFUSED;
  return (status & POWER_REFUSED) == 0 ? 0 : -1;
}

int cluster_on(void) {
  POWER_MANAGER_CLUSTER_BOOT = (uint32_t)(uintptr_t)cluster_start;
  POWER_MANAGER_CLUSTER_POWER = 1;
  return granted();
}

void cluster_off(void) {
  POWER_MANAGER_CLUSTER_POWER = 0;
}

int cluster_clock_set(uint32_t hz) {
  POWER_MANAGER_CLUSTER_CLOCK_HZ = hz;
  return granted();
}

unsigned cluster_core_count(void) {
  return EVENT_UNIT_CORE_COUNT;
}

int cluster_fork(cluster_entry_t entry, unsigned cores, void* argument) {
  EVENT_UNIT_EVENT_CLEAR = EVENT_JOB;
  EVENT_UNIT_FORK_ENTRY = (uint32_t)(uintptr_t)entry;
  EVENT_UNIT_FORK_ARGUMENT = (uint32_t)(uintptr_t)argument;
  EVENT_UNIT_FORK_CORES = cores >= 32 ? 0 : (UINT32_C(1) << cores) - 1;
  const uint32_t refused = EVENT_UNIT_STATUS;
  EVENT_UNIT_STATUS = refused;
  return refused == 0 ? 0 : -1;
}

void cluster_wait(void) {
  while (EVENT_UNIT_FORK_CORES != 0) {
    wait_for(EVENT_JOB);
  }
}

static uint32_t start(uint32_t direction, uint32_t l1, uint32_t l2, uint32_t bytes, uint32_t row, uint32_t stride) {
  while ((CLUSTER_DMA_STATUS & DMA_ALL_IN_USE) == DMA_ALL_IN_USE) {
    wait_for(EVENT_DMA);
  }
  CLUSTER_DMA_L1_ADDRESS = l1;
  CLUSTER_DMA_L2_ADDRESS = l2;
  CLUSTER_DMA_SIZE = bytes;
  CLUSTER_DMA_ROW = row;
  CLUSTER_DMA_STRIDE = stride;
  CLUSTER_DMA_START = direction;
  if ((CLUSTER_DMA_STATUS & DMA_STATUS_REFUSED) != 0) {
    CLUSTER_DMA_STATUS = DMA_STATUS_REFUSED;
    return DMA_REFUSED;
  }
  return CLUSTER_DMA_START;
}

#include "runtime/dma_copies.h"

void dma_wait(uint32_t copy) {
  while ((CLUSTER_DMA_STATUS >> copy & 1u) != 0) {
    wait_for(EVENT_DMA);
  }
}
