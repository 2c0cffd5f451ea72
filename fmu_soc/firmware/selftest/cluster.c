// SPDX-License-Identifier: Apache-2.0
// Tests the cluster's runtime: fork, barrier, DMA, several jobs, and switching off and on. The exit code is 0, or the
// number of the check that failed.
#include "runtime/cluster.h"
#include "runtime/console.h"

#define CORES 8
#define COUNT 4096
#define ROWS 16
#define COPIES 16

static int32_t source[COUNT];
static int32_t result[COUNT];
static CLUSTER_L1 int32_t tile[COUNT];
static CLUSTER_L1 volatile uint32_t arrived[CORES];
static uint32_t seen[CORES];

struct job {
  unsigned cores;
  int32_t factor;
};

// Computes a part of the result on each core. Core 0 copies the data to L1 and back.
static void scale(void* argument) {
  const struct job* job = argument;
  const unsigned core = cluster_core_id();
  if (core == 0) {
    dma_wait(dma_copy_in(tile, source, sizeof tile));
  }
  cluster_barrier();
  for (unsigned i = core; i < COUNT; i += job->cores) {
    tile[i] *= job->factor;
  }
  cluster_barrier();
  if (core == 0) {
    dma_wait(dma_copy_out(result, tile, sizeof tile));
  }
}

// Tests that after a barrier, every core sees the stores of all cores before the barrier.
static void meet(void* argument) {
  const unsigned cores = (unsigned)(uintptr_t)argument;
  const unsigned core = cluster_core_id();
  for (unsigned round = 1; round <= 20; ++round) {
    for (volatile unsigned delay = 0; delay < core * round; ++delay) {
    }
    arrived[core] = round;
    cluster_barrier();
    for (unsigned other = 0; other < cores; ++other) {
      if (arrived[other] < round) {
        return;
      }
    }
    cluster_barrier();
  }
  seen[core] = 20;
}

int main(void) {
  cluster_off();
  if (cluster_on() != 0) return 1;
  if (cluster_on() != 0) return 16;
  if (cluster_core_count() != CORES) return 2;
  for (int32_t i = 0; i < COUNT; ++i) source[i] = i - 1000;
  for (unsigned cores = 1; cores <= CORES; ++cores) {
    struct job job = {cores, (int32_t)cores + 2};
    if (cluster_fork(scale, cores, &job) != 0) return 3;
    cluster_wait();
    for (int32_t i = 0; i < COUNT; ++i) {
      if (result[i] != (i - 1000) * job.factor) return 4;
    }
  }
  if (cluster_fork(meet, CORES, (void*)CORES) != 0) return 5;
  if (cluster_fork(meet, 1, (void*)1) != -1) return 6;
  cluster_wait();
  for (unsigned core = 0; core < CORES; ++core) {
    if (seen[core] != 20) return 7;
  }
  if (cluster_fork(meet, CORES + 1, 0) != -1) return 8;

  // Copies every fourth word of a picture of ROWS rows into L1, and then to another address in L2.
  dma_wait(dma_copy_in_2d(tile, source, ROWS * 4, 4, 16));
  dma_wait(dma_copy_out_2d(result, tile, ROWS * 4, 4, 8));
  for (int32_t row = 0; row < ROWS; ++row) {
    if (result[2 * row] != 4 * row - 1000) return 9;
  }
  if (dma_copy_in(tile, (const void*)0x1000, 4) != DMA_REFUSED) return 10;
  dma_wait(DMA_REFUSED);

  uint32_t copies[COPIES];
  for (int i = 0; i < COPIES; ++i) copies[i] = dma_copy_in(&tile[i], &source[COPIES - i], 4);
  for (int i = 0; i < COPIES; ++i) dma_wait(copies[i]);
  dma_wait(dma_copy_out(result, tile, COPIES * 4));
  for (int32_t i = 0; i < COPIES; ++i) {
    if (result[i] != COPIES - i - 1000) return 17;
  }

  cluster_off();
  cluster_off();
  if (cluster_clock_set(175000001) != -1) return 11;
  if (cluster_clock_set(100000000) != 0) return 12;
  if (cluster_on() != 0) return 13;
  struct job job = {3, -7};
  if (cluster_fork(scale, 3, &job) != 0) return 14;
  cluster_wait();
  for (int32_t i = 0; i < COUNT; ++i) {
    if (result[i] != (i - 1000) * -7) return 15;
  }
  cluster_off();
  print("cluster: all right\n");
  return 0;
}
