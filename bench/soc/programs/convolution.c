// SPDX-License-Identifier: Apache-2.0
// A typical layer for small drones: 3 x 3 convolution on int8, 4 input and 8 output channels, ReLU, rescaled to int8.
#include <stdint.h>

#define SIDE 40
#define PADDED (SIDE + 2)
#define CHANNELS_IN 4
#define CHANNELS_OUT 8

static int8_t image[CHANNELS_IN][PADDED][PADDED];
static int8_t weights[CHANNELS_OUT][CHANNELS_IN][3][3];
static int32_t bias[CHANNELS_OUT];
static int8_t result[CHANNELS_OUT][SIDE][SIDE];

static uint32_t noise(void) {
  static uint32_t state = 1;
  state = state * 1103515245U + 12345U;
  return state >> 16;
}

static __attribute__((noinline)) void convolve(int channel) {
  for (int y = 0; y < SIDE; ++y) {
    for (int x = 0; x < SIDE; ++x) {
      int32_t sum = bias[channel];
      for (int c = 0; c < CHANNELS_IN; ++c) {
        for (int v = 0; v < 3; ++v) {
          const int8_t* pixel = &image[c][y + v][x];
          const int8_t* weight = weights[channel][c][v];
          sum += pixel[0] * weight[0] + pixel[1] * weight[1] + pixel[2] * weight[2];
        }
      }
      sum >>= 9;
      if (sum < 0) sum = 0;
      if (sum > 127) sum = 127;
      result[channel][y][x] = (int8_t)sum;
    }
  }
}

int main(void) {
  uint32_t hash = 0;
  for (int8_t* p = &image[0][0][0]; p != &image[CHANNELS_IN][0][0]; ++p) *p = (int8_t)noise();
  for (int8_t* p = &weights[0][0][0][0]; p != &weights[CHANNELS_OUT][0][0][0]; ++p) *p = (int8_t)noise();
  for (int turn = 0; turn < TURNS; ++turn) {
    for (int o = 0; o < CHANNELS_OUT; ++o) {
      bias[o] = turn - 64 * o;
      convolve(o);
    }
    image[turn & 3][1 + turn % SIDE][1] ^= 1;
    hash = hash * 31 + (uint8_t)result[turn % CHANNELS_OUT][turn % SIDE][7];
  }
  return (int)(hash ^ hash >> 16);
}
