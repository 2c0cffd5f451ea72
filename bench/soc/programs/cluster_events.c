// SPDX-License-Identifier: Apache-2.0
// Executes an event TURNS times. EVENT selects the event: 1 is a barrier of eight cores, 2 is a DMA copy of 256 bytes
// and waiting for its end.
#include <stdint.h>

#include "runtime/cluster.h"

#define BYTES 256

static CLUSTER_L1 uint8_t near[BYTES];
static uint8_t far[BYTES];

static void work(void* nothing) {
  (void)nothing;
  for (uint32_t turn = 0; turn < TURNS; ++turn) {
#if EVENT == 1
    cluster_barrier();
#else
    dma_wait(dma_copy_in(near, far, BYTES));
#endif
  }
}

int main(void) {
  if (cluster_on() != 0 || cluster_fork(work, EVENT == 1 ? 8 : 1, 0) != 0) {
    return 127;
  }
  cluster_wait();
  return 1;
}
