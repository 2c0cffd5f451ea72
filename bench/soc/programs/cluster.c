// SPDX-License-Identifier: Apache-2.0
// Computes the layer of convolution.c on CORES cores of the cluster. Each core computes some of the output channels.
// All data are in L1. One core does the same work as eight.
#include <stdint.h>

#include "runtime/cluster.h"

#define SIDE 40
#define PADDED (SIDE + 2)
#define CHANNELS_IN 4
#define CHANNELS_OUT 8

static CLUSTER_L1 int8_t image[CHANNELS_IN][PADDED][PADDED];
static CLUSTER_L1 int8_t weights[CHANNELS_OUT][CHANNELS_IN][3][3];
static CLUSTER_L1 int8_t result[CHANNELS_OUT][SIDE][SIDE];
static CLUSTER_L1 uint32_t hash;

static void fill(int8_t* first, const int8_t* end) {
  static uint32_t state = 1;
  for (int8_t* p = first; p != end; ++p) {
    state = state * 1103515245U + 12345U;
    *p = (int8_t)(state >> 16);
  }
}

static __attribute__((noinline)) void convolve(int channel, int32_t bias) {
  for (int y = 0; y < SIDE; ++y) {
    for (int x = 0; x < SIDE; ++x) {
      int32_t sum = bias;
      for (int c = 0; c < CHANNELS_IN; ++c) {
        for (int v = 0; v < 3; ++v) {
          const int8_t* pixel = &image[c][y + v][x];
          const int8_t* weight = weights[channel][c][v];
          sum += pixel[0] * weight[0] + pixel[1] * weight[1] + pixel[2] * weight[2];
        }
      }
      sum >>= 9;
      result[channel][y][x] = (int8_t)(sum < 0 ? 0 : sum > 127 ? 127 : sum);
    }
  }
}

static void work(void* nothing) {
  (void)nothing;
  for (int turn = 0; turn < TURNS; ++turn) {
    for (int o = (int)cluster_core_id(); o < CHANNELS_OUT; o += CORES) {
      convolve(o, turn - 64 * o);
    }
    cluster_barrier();
    if (cluster_core_id() == 0) {
      image[turn & 3][1 + turn % SIDE][1] ^= 1;
      hash = hash * 31 + (uint8_t)result[turn % CHANNELS_OUT][turn % SIDE][7];
    }
    cluster_barrier();
  }
}

int main(void) {
  if (cluster_on() != 0) {
    return 127;
  }
  fill(&image[0][0][0], &image[CHANNELS_IN][0][0]);
  fill(&weights[0][0][0][0], &weights[CHANNELS_OUT][0][0][0]);
  hash = 0;
  if (cluster_fork(work, CORES, 0) != 0) {
    return 126;
  }
  cluster_wait();
  return (int)((hash ^ hash >> 7 ^ hash >> 14) & 0x3f);
}
