// SPDX-License-Identifier: Apache-2.0
// The cluster: up to eight cores, their shared memory L1, and the DMA that fills and empties it.
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

// An object in L1, without first value. It is there only while the cluster is on, and lost when it goes off.
#define CLUSTER_L1 __attribute__((section(".l1")))

typedef void (*cluster_entry_t)(void* argument);

// For the fabric controller.

// Switches the cluster on; its cores wait for work. 0, or -1 when the chip has no cluster.
int cluster_on(void);
// Switches it off. Work under way is lost.
void cluster_off(void);
// Clock of the cluster [Hz]. 0, or -1 when the chip's voltage does not allow it; the clock stays then.
int cluster_clock_set(uint32_t hz);
// Cores that the cluster has.
unsigned cluster_core_count(void);
// Calls entry(argument) on cores 0 to cores - 1 and returns at once. 0, or -1 when there are not so many cores or
// some still work.
int cluster_fork(cluster_entry_t entry, unsigned cores, void* argument);
// Sleeps until all cores of the fork have returned.
void cluster_wait(void);

// For the cluster's cores.

// 0 to 7.
static inline unsigned cluster_core_id(void) {
  unsigned id;
  __asm__("csrr %0, mhartid" : "=r"(id));
  return id;
}

// Sleeps until all cores of the fork have come here.
static inline void cluster_barrier(void) {
  event_load(BARRIER_ADDRESS);
}

// For both: the DMA. A copy starts and runs by itself, after those started before it; its number is for dma_wait.
// Who started it, core or fabric controller, must wait for it exactly once. With 16 under way, a start waits for an
// end. GAP8's own DMA: at most 16 of all cores together that nobody has waited for, or the program may stop; 65535
// bytes. DMA_REFUSED: addresses or sizes that do not fit; dma_wait() returns at once.
#define DMA_REFUSED 0xffffffffu

uint32_t dma_copy_in(void* l1, const void* l2, uint32_t bytes);
uint32_t dma_copy_out(void* l2, const void* l1, uint32_t bytes);
// Rows of `row` bytes that lie `stride` bytes apart in L2 and one after the other in L1; `bytes` = all rows together.
uint32_t dma_copy_in_2d(void* l1, const void* l2, uint32_t bytes, uint32_t row, uint32_t stride);
uint32_t dma_copy_out_2d(void* l2, const void* l1, uint32_t bytes, uint32_t row, uint32_t stride);
// Sleeps until the copy has ended.
void dma_wait(uint32_t copy);

#ifdef __cplusplus
}
#endif
