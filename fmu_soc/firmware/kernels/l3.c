// SPDX-License-Identifier: Apache-2.0
// Copies weights from HyperRAM to L2 by GAP8's uDMA while the cores compute. On other machines, copies are immediate.
#include "kernels/l3.h"

#ifdef __riscv

#include "runtime/registers.h"

#define FLASH_BASE 0x1000000u  // reset value of MEM_CFG4
#define MOST_BYTES 0x10000u    // maximum bytes of a transfer, whose size has 17 bits

static void transfer(uint32_t channel, void* memory, uint32_t outside, uint32_t bytes) {
  store(UDMA_BASE + UDMA_HYPER_OUTSIDE_OFFSET, outside);
  udma_start(channel, memory, bytes);
}

static void wait_for(uint32_t channel) {
  while (udma_runs(channel)) {
  }
}

static struct {
  uint8_t* to;
  uint32_t from;
  uint32_t bytes;
} left;

static uint32_t smaller(uint32_t a, uint32_t b) {
  return a < b ? a : b;
}

static void advance(void) {
  while (left.bytes > 0 && !udma_is_full(UDMA_HYPER_RECEIVE_OFFSET)) {
    const uint32_t part = smaller(left.bytes, MOST_BYTES);
    transfer(UDMA_HYPER_RECEIVE_OFFSET, left.to, left.from, part);
    left.to += part;
    left.from += part;
    left.bytes -= part;
  }
}

static void fetch(uint8_t* to, uint32_t from, uint32_t bytes) {
  left.to = to;
  left.from = from;
  left.bytes = bytes;
  advance();
}

static void layer_l3_wait(void) {
  while (left.bytes > 0) {
    advance();
  }
  wait_for(UDMA_HYPER_RECEIVE_OFFSET);
}

const layer_l3_t layer_l3 = {fetch, advance, layer_l3_wait};

void layer_l3_load(uint32_t flash, uint32_t bytes, uint8_t* buffer, uint32_t buffer_bytes) {
  const uint32_t most = smaller(buffer_bytes & ~3u, MOST_BYTES);
  for (uint32_t at = 0; at < bytes; at += most) {
    const uint32_t part = smaller(bytes - at, most);
    transfer(UDMA_HYPER_RECEIVE_OFFSET, buffer, FLASH_BASE + flash + at, part);
    wait_for(UDMA_HYPER_RECEIVE_OFFSET);
    transfer(UDMA_HYPER_SEND_OFFSET, buffer, at, part);
    wait_for(UDMA_HYPER_SEND_OFFSET);
  }
}

#else

#include <string.h>

extern const uint8_t network_weights[];

static void fetch(uint8_t* to, uint32_t from, uint32_t bytes) {
  memcpy(to, network_weights + from, bytes);
}

static void nothing(void) {}

const layer_l3_t layer_l3 = {fetch, nothing, nothing};

void layer_l3_load(uint32_t flash, uint32_t bytes, uint8_t* buffer, uint32_t buffer_bytes) {
  (void)flash;
  (void)bytes;
  (void)buffer;
  (void)buffer_bytes;
}

#endif
