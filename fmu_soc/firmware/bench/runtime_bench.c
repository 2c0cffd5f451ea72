// SPDX-License-Identifier: Apache-2.0
// Measures the runtime's services on a board [ps]: switching the cluster on and off, a fork with its wait, a barrier,
// and a copy of the DMA with its wait. Prints one line for one core and one line for all cores.
#include <stdbool.h>

#include "drivers/timer.h"
#include "runtime/cluster.h"
#include "runtime/console.h"
#include "runtime/interrupt.h"

#define TURNS 50000
#define SWITCHES 100

static uint8_t outside[1024] __attribute__((aligned(4)));
static CLUSTER_L1 uint8_t inside[1024] __attribute__((aligned(4)));

static void nothing(void* argument) {
  (void)argument;
}

static void meet(void* argument) {
  (void)argument;
  for (int i = 0; i < TURNS; ++i) {
    cluster_barrier();
  }
}

// Core 0 starts a copy and waits for its end; the other cores return.
static void copy(void* argument) {
  if (cluster_core_id() != 0) {
    return;
  }
  for (int i = 0; i < TURNS; ++i) {
    dma_wait(dma_copy_in(inside, outside, (uint32_t)(uintptr_t)argument));
  }
}

static uint32_t each(int64_t begin_ns, uint32_t turns) {
  return (uint32_t)((uint64_t)(timer_now_ns() - begin_ns) * 1000 / turns);
}

static uint32_t fork_of(cluster_entry_t entry, unsigned cores, uintptr_t argument) {
  const int64_t begin_ns = timer_now_ns();
  cluster_fork(entry, cores, (void*)argument);
  cluster_wait();
  return each(begin_ns, TURNS);
}

// Prints a line for a team of `cores` cores. Returns false if a fork is refused.
static bool measure(unsigned cores) {
  const int64_t begin_ns = timer_now_ns();
  for (int i = 0; i < TURNS; ++i) {
    if (cluster_fork(nothing, cores, 0) != 0) {
      return false;
    }
    cluster_wait();
  }
  const uint32_t fork_ps = each(begin_ns, TURNS);
  print("%u cores: fork %u", cores, fork_ps);
  print(", barrier %u", fork_of(meet, cores, 0));
  print(", copy of 4 bytes %u", fork_of(copy, cores, 4));
  print(", of 1024 %u\n", fork_of(copy, cores, sizeof inside));
  return true;
}

int main(void) {
  interrupts_off();
  if (cluster_on() != 0) {
    print("no cluster\n");
    return 1;
  }
  const unsigned all = cluster_core_count();
  if (!measure(1) || (all > 1 && !measure(all))) {
    print("no fork\n");
    return 1;
  }
  const int64_t begin_ns = timer_now_ns();
  for (int i = 0; i < SWITCHES; ++i) {
    cluster_off();
    if (cluster_on() != 0) {
      print("not on again\n");
      return 1;
    }
  }
  print("off and on %u\n", each(begin_ns, SWITCHES));
  return 0;
}
