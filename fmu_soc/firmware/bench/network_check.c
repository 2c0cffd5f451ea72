// SPDX-License-Identifier: Apache-2.0
// Takes all pictures of the camera, and prints the results of every kernel. For pictures of 168 x 168 pixels, which is
// the network's size, prints:
// plain|alone|cluster<cores> outputs checksum-of-each-layer
// For larger pictures, prints:
// whole<cores> outputs
#include <stdint.h>

#include "drivers/camera.h"
#include "drivers/timer.h"
#include "nn/cluster_net.h"
#include "nn/fast.h"
#include "runtime/cluster.h"
#include "runtime/console.h"
#include "runtime/interrupt.h"

// Plain code is slow, so it only processes the first pictures.
#define PLAIN_PICTURES 2
#define PATIENCE_NS (INT64_C(200) * NS_PER_MS)

static nn_arena_t arena __attribute__((aligned(16), section(".noinit.arena")));
static nn_activations_t activations __attribute__((aligned(4), section(".noinit.activations")));
static nn_small_weights_t small_weights;
static unsigned cluster_cores;
static int8_t pixels[NN_PICTURE_BYTES] __attribute__((aligned(4), section(".noinit.pixels")));

static void print_hex(uint32_t hash) {
  print(" %x", hash);
}

static void print_output(const char* kernel, nn_output_t output) {
  print("%s", kernel);
  for (int i = 0; i < NN_OUTPUTS; ++i) {
    print(" %d", (int32_t)NN_OUTPUT(output, i));
  }
}

static void check_plain(void) {
  const nn_output_t output = nn_plain_infer(pixels, &activations);
  const struct {
    const void* bytes;
    int count;
  } layers[] = {{activations.pooled, sizeof(activations.pooled)},  {activations.second, sizeof(activations.second)},
                {activations.third, sizeof(activations.third)},    {activations.fourth, sizeof(activations.fourth)},
                {activations.fifth, sizeof(activations.fifth)},    {activations.sixth, sizeof(activations.sixth)},
                {activations.seventh, sizeof(activations.seventh)}};
  print_output("plain", output);
  for (int i = 0; i < NN_CONVOLUTIONS; ++i) {
    print_hex(nn_checksum(layers[i].bytes, layers[i].count, NN_CHECKSUM_START));
  }
  print("\n");
}

static void check_alone(void) {
  for (int y = 0; y < SHRUNK_EDGE; ++y) {
    for (int x = 0; x < SHRUNK_EDGE; ++x) {
      arena.picture[(y + 2) * NN_PICTURE_PITCH + 2 + x] = pixels[y * SHRUNK_EDGE + x];
    }
  }
  print_output("alone", nn_fast_infer_alone(&arena, &small_weights));
  for (int i = 0; i < NN_CONVOLUTIONS; ++i) {
    print_hex(nn_fast_checksum(&arena, i));
  }
  print("\n");
}

// Checks a picture of the network's size. Switches the cluster off and on, so that L1 has no data of the previous
// picture.
static void check_cluster(unsigned cores) {
  cluster_on();
  print("cluster%u", cores);
  print_output("", nn_cluster_infer_shrunk(pixels, cores));
  for (int i = 0; i < NN_CONVOLUTIONS; ++i) {
    print_hex(nn_cluster_checksum(i));
  }
  print("\n");
  cluster_off();
}

// Checks a picture of the camera's size, which the cluster reduces in L1.
static void check_whole(const picture_t* picture) {
  for (unsigned cores = 1; cores <= cluster_cores; cores *= 2) {
    cluster_on();
    print("whole%u", cores);
    print_output("", nn_cluster_infer(picture->pixels, picture->width, picture->height, cores));
    print("\n");
    cluster_off();
  }
}

int main(void) {
  interrupts_off();
  timer_init();
  camera_init();
  nn_fast_make_small_weights(&small_weights);
  nn_cluster_init();
  if (cluster_on() == 0) {
    cluster_cores = cluster_core_count();
    cluster_off();
  }
  for (int taken = 0;; ++taken) {
    picture_t picture;
    if (camera_take(&picture, timer_now_ns() + PATIENCE_NS) != PICTURE_TAKEN) {
      print("%d pictures\n", (int32_t)taken);
      return taken > 0 ? 0 : 1;
    }
    if (picture.width != SHRUNK_EDGE) {
      check_whole(&picture);
      continue;
    }
    for (int i = 0; i < NN_PICTURE_BYTES; ++i) {
      pixels[i] = (int8_t)(picture.pixels[i] - 128);
    }
    if (taken < PLAIN_PICTURES) {
      check_plain();
    }
    check_alone();
    for (unsigned cores = 1; cores <= cluster_cores; cores *= 2) {
      check_cluster(cores);
    }
  }
}
