// SPDX-License-Identifier: Apache-2.0
// Takes pictures of 168 x 168 pixels by the camera, as many as there come, and tells what every kernel makes of each:
//   plain|alone yaw checksum-of-each-layer
#include <stdint.h>

#include "drivers/camera.h"
#include "drivers/timer.h"
#include "nn/fast.h"
#include "runtime/console.h"
#include "runtime/interrupt.h"

// Plain code takes its time: only the first pictures.
#define PLAIN_PICTURES 2
#define PATIENCE_NS (INT64_C(200) * NS_PER_MS)

static nn_arena_t arena __attribute__((aligned(16), section(".noinit.arena")));
static nn_activations_t activations __attribute__((aligned(4), section(".noinit.activations")));
static int8_t pixels[NN_PICTURE_BYTES] __attribute__((aligned(4), section(".noinit.pixels")));

static void print_hex(uint32_t hash) {
  print(" %x", hash);
}

static void check_plain(void) {
  const int8_t yaw = nn_plain_infer(pixels, &activations);
  const struct {
    const void* bytes;
    int count;
  } layers[] = {{activations.pooled, sizeof(activations.pooled)}, {activations.second, sizeof(activations.second)},
                {activations.third, sizeof(activations.third)},   {activations.fourth, sizeof(activations.fourth)},
                {activations.fifth, sizeof(activations.fifth)},   {activations.sixth, sizeof(activations.sixth)},
                {activations.seventh, sizeof(activations.seventh)}};
  print("plain %d", (int32_t)yaw);
  for (int i = 0; i < NN_CONVOLUTIONS; ++i) {
    print_hex(nn_checksum(layers[i].bytes, layers[i].count, NN_CHECKSUM_START));
  }
  print("\n");
}

static void put_picture(void) {
  const nn_share_t all = {0, 1};
  nn_fast_border(&arena, all);
  for (int y = 0; y < SHRUNK_EDGE; ++y) {
    for (int x = 0; x < SHRUNK_EDGE; ++x) {
      arena.picture[(y + 2) * NN_PICTURE_PITCH + 2 + x] = pixels[y * SHRUNK_EDGE + x];
    }
  }
}

static void check_alone(void) {
  put_picture();
  const int8_t yaw = nn_fast_infer_alone(&arena);
  print("alone %d", (int32_t)yaw);
  for (int i = 0; i < NN_CONVOLUTIONS; ++i) {
    print_hex(nn_fast_checksum(&arena, i));
  }
  print("\n");
}

int main(void) {
  interrupts_off();
  timer_init();
  camera_init();
  nn_fast_clear(&arena);
  for (int taken = 0;; ++taken) {
    picture_t picture;
    if (camera_take(&picture, timer_now_ns() + PATIENCE_NS) != PICTURE_TAKEN) {
      print("%d pictures\n", (int32_t)taken);
      return taken > 0 ? 0 : 1;
    }
    for (int i = 0; i < NN_PICTURE_BYTES; ++i) {
      pixels[i] = (int8_t)(picture.pixels[i] - 128);
    }
    if (taken < PLAIN_PICTURES) {
      check_plain();
    }
    check_alone();
  }
}
