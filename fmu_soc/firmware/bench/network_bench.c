// SPDX-License-Identifier: Apache-2.0
// Runs inferences without pause, for mebots-network-bench. For each number of cores, prints a line before the
// inferences, and a line with their time [ns] after them.
#include <stdint.h>

#include "drivers/timer.h"
#include "nn/cluster_net.h"
#include "runtime/cluster.h"
#include "runtime/console.h"
#include "runtime/interrupt.h"

#define WIDTH 320
#define HEIGHT 320
#define INFERENCES 8

// The time does not depend on the content of the picture.
static uint8_t frame[WIDTH * HEIGHT] __attribute__((aligned(4), section(".noinit.frame")));

int main(void) {
  interrupts_off();
  nn_cluster_init();
  for (unsigned cores = 1; cores <= 8; cores *= 2) {
    if (cluster_on() != 0) {
      print("no cluster\n");
      return 1;
    }
    // The first inference fills the instruction caches.
    nn_cluster_infer(frame, WIDTH, HEIGHT, cores);
    const uint32_t begin_ns = (uint32_t)timer_now_ns();
    print("begin %u %u\n", cores, (uint32_t)INFERENCES);
    for (int i = 0; i < INFERENCES; ++i) {
      nn_cluster_infer(frame, WIDTH, HEIGHT, cores);
    }
    print("end %u\n", (uint32_t)timer_now_ns() - begin_ns);
    cluster_off();
  }
  return 0;
}
