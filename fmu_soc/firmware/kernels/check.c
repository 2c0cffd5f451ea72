// SPDX-License-Identifier: Apache-2.0
// Runs a deployed network. `mebots deploy` writes the picture and the request into this program. The program prints the
// results and a hash of each layer's output. If `layers` of the request is not negative, it only computes this number
// of layers, for a measurement.
#include <stdint.h>

#include "network.h"

#ifdef __riscv
#include "runtime/cluster.h"
#include "runtime/console.h"
#include "runtime/interrupt.h"
#else
#include <stdio.h>
#define print printf
#endif

typedef struct {
  char mark[16];  // marks the place of the request in the file
  int32_t cores;
  int32_t clock_hz;               // clock of the cluster
  int32_t layers;                 // >= 0: computes this number of layers; -1: checks all layers
  int32_t bytes[NETWORK_LAYERS];  // bytes of each layer's output
  uint8_t picture[NETWORK_PICTURE_BYTES];
} request_t;

static volatile request_t request
    __attribute__((aligned(16), section(".data"))) = {"mebots-request:", 0, 0, 0, {0}, {0}};

static uint32_t hash_of(const uint8_t* bytes, int32_t count) {
  uint32_t hash = 2166136261U;  // FNV-1a
  for (int32_t i = 0; i < count; ++i) {
    hash = (hash ^ bytes[i]) * 16777619U;
  }
  return hash;
}

static int start(void) {
#ifdef __riscv
  interrupts_off();
  if (cluster_on() != 0) {
    print("the chip has no cluster\n");
    return 1;
  }
  if (cluster_clock_set((uint32_t)request.clock_hz) != 0) {
    print("the voltage does not allow a clock of %d Hz\n", request.clock_hz);
    return 1;
  }
  return 0;
#else
  return 0;
#endif
}

int main(void) {
  const uint8_t* picture = (const uint8_t*)request.picture;
  const unsigned cores = (unsigned)request.cores;
  if (start() != 0) {
    return 1;
  }
  network_load(0);
  if (request.layers >= 0) {
    if (request.layers > 0) {
      network_run_layers(cores, picture, 0, request.layers);
    }
    return 0;
  }
  for (int i = 0; i < NETWORK_LAYERS; ++i) {
    const uint8_t* bytes = network_run_layers(cores, picture, i, 1);
    print("layer %d %x\n", i, hash_of(bytes, request.bytes[i]));
  }
  static network_result_t result;
  if (network_run_on(cores, picture, &result) != 0) {
    print("the cores are at work\n");
    return 1;
  }
  const int32_t* values = (const int32_t*)&result;
  for (unsigned i = 0; i < sizeof(result) / sizeof(int32_t); ++i) {
    print("result %d\n", (int)values[i]);
  }
  return 0;
}
