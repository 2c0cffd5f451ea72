// SPDX-License-Identifier: Apache-2.0
// Controls the cluster: up to eight cores, their shared memory L1, and the DMA between L1 and L2.
//
//   cluster_on();
//   cluster_fork(work, 8, &job);   // void work(void* job), on each core
//   cluster_wait();                // the fabric controller sleeps meanwhile
//   cluster_off();
#pragma once

#include <stdint.h>

#include "runtime/barrier.h"
#include "runtime/event_load.h"

#ifdef __cplusplus
extern "C" {
#endif

// Places an uninitialised object in L1, where it exists only while the cluster is on.
#define CLUSTER_L1 __attribute__((section(".l1")))

typedef void (*cluster_entry_t)(void* argument);

// Only the fabric controller may call these functions.

// Switches the cluster on. Returns 0, or -1 if the chip has no cluster.
int cluster_on(void);
// Switches the cluster off. Unfinished work is lost.
void cluster_off(void);
// Sets the clock of the cluster [Hz]. Returns 0. If the voltage does not allow this clock, returns -1 without effect.
int cluster_clock_set(uint32_t hz);
unsigned cluster_core_count(void);
// Calls entry(argument) on cores 0 to cores - 1, and returns at once. Returns 0. If the cluster has fewer cores, or if
// some of them are still working, returns -1.
int cluster_fork(cluster_entry_t entry, unsigned cores, void* argument);
// Sleeps until all cores of the fork have returned.
void cluster_wait(void);

// Only the cluster's cores may call these functions.

// Returns the number of the core, 0 to 7.
static inline unsigned cluster_core_id(void) {
  unsigned id;
  __asm__("csrr %0, mhartid" : "=r"(id));
  return id;
}

// Sleeps until all cores of the fork have reached the barrier.
static inline void cluster_barrier(void) {
  event_load(BARRIER_ADDRESS);
}

// The fabric controller and the cluster's cores may call these functions. A copy by the DMA runs in parallel to the
// cores, after all earlier copies. The result is the number of the copy; the core that started the copy must pass it to
// dma_wait() exactly once. If 16 copies are running, the next start waits until one of them ends. For invalid addresses
// or sizes, the result is DMA_REFUSED, and dma_wait() returns at once.
//
// On GAP8's own DMA, a copy occupies one of 16 counters until dma_wait() has returned. If all are occupied, a start
// waits until another core calls dma_wait(), possibly without end. A copy has at most 65535 bytes there.
#define DMA_REFUSED 0xffffffffu

uint32_t dma_copy_in(void* l1, const void* l2, uint32_t bytes);
uint32_t dma_copy_out(void* l2, const void* l1, uint32_t bytes);
// Copy rows of `row` bytes, which are `stride` bytes apart in L2 and contiguous in L1. `bytes` is the total size.
uint32_t dma_copy_in_2d(void* l1, const void* l2, uint32_t bytes, uint32_t row, uint32_t stride);
uint32_t dma_copy_out_2d(void* l2, const void* l1, uint32_t bytes, uint32_t row, uint32_t stride);
// Sleeps until the copy has ended.
void dma_wait(uint32_t copy);

#ifdef __cplusplus
}
#endif
