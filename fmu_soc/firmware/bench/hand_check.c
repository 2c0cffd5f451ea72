// SPDX-License-Identifier: Apache-2.0
// Compares the kernels scheduled by hand with those scheduled by the compiler, on eight cores, with noise as input.
// Prints the cluster's cycles of both versions of each kernel. The exit code is 1 if the bytes of the versions differ,
// or if the version scheduled by hand is not faster.
#include <stdint.h>

#include "drivers/timer.h"
#include "nn/hand.h"
#include "runtime/cluster.h"
#include "runtime/console.h"
#include "runtime/interrupt.h"

#define EDGE 320
#define CORES 8
#define CLUSTER_MHZ 50

static nn_arena_t arena CLUSTER_L1;
static uint16_t columns[SHRUNK_EDGE] CLUSTER_L1;
static nn_small_weights_t small_weights;

static void (*kernel)(nn_share_t share);

static void fast_shrink(nn_share_t share) {
  for (int stripe = 0; stripe < NN_STRIPES; ++stripe) {
    nn_fast_shrink(&arena, arena.stripes[stripe & 1], EDGE, EDGE, columns, stripe * NN_STRIPE_ROWS, NN_STRIPE_ROWS,
                   share);
  }
}

static void hand_shrink(nn_share_t share) {
  for (int stripe = 0; stripe < NN_STRIPES; ++stripe) {
    nn_hand_shrink(&arena, arena.stripes[stripe & 1], EDGE, EDGE, columns, stripe * NN_STRIPE_ROWS, NN_STRIPE_ROWS,
                   share);
  }
}

static void fast_first(nn_share_t share) {
  nn_fast_first(&arena, share);
}

static void hand_first(nn_share_t share) {
  nn_hand_first(&arena, share);
}

// Fills the arena, including the borders of the tensors, with noise. Then stores the small weights in it.
static void prepare(nn_share_t share) {
  if (share.core == 0) {
    uint32_t noise = 1;
    uint8_t* at = (uint8_t*)&arena;
    for (unsigned i = 0; i < sizeof arena; ++i) at[i] = (uint8_t)((noise = noise * 1664525u + 1013904223u) >> 24);
    arena.small = small_weights;
    shrink_columns(EDGE, columns);
  }
}

static uint32_t checksum;
static void add_up(nn_share_t share) {
  if (share.core == 0) checksum = nn_checksum(&arena, sizeof arena, NN_CHECKSUM_START);
}

static void work(void* argument) {
  (void)argument;
  const nn_share_t share = {cluster_core_id(), CORES};
  kernel(share);
}

static uint32_t run(void (*what)(nn_share_t)) {
  kernel = what;
  const uint32_t begin_ns = (uint32_t)timer_now_ns();
  cluster_fork(work, CORES, 0);
  cluster_wait();
  return ((uint32_t)timer_now_ns() - begin_ns) * CLUSTER_MHZ / 1000;
}

// Calls a kernel twice. Returns the cycles of the second call, which has a warm instruction cache.
static uint32_t measured(void (*what)(nn_share_t), uint32_t* bytes) {
  run(prepare);
  run(what);
  const uint32_t cycles = run(what);
  run(add_up);
  *bytes = checksum;
  return cycles;
}

static int compare(const char* name, void (*fast)(nn_share_t), void (*hand)(nn_share_t)) {
  uint32_t bytes[2];
  const uint32_t by_compiler = measured(fast, &bytes[0]);
  const uint32_t by_hand = measured(hand, &bytes[1]);
  print("%s %u %u %s\n", name, by_compiler, by_hand, bytes[0] == bytes[1] ? "same" : "different");
  return bytes[0] != bytes[1] || by_hand >= by_compiler;
}

int main(void) {
  interrupts_off();
  timer_init();
  nn_fast_make_small_weights(&small_weights);
  if (cluster_on() != 0 || cluster_clock_set(CLUSTER_MHZ * 1000000u) != 0) {
    print("no cluster\n");
    return 1;
  }
  return compare("shrink", fast_shrink, hand_shrink) | compare("first", fast_first, hand_first);
}
