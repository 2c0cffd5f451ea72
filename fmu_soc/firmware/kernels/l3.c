// SPDX-License-Identifier: Apache-2.0
// Weights in HyperRAM, which GAP8's uDMA copies to L2 while the cores compute. On another machine, copies are
// immediate.
#include "kernels/l3.h"

#ifdef __riscv

#include "board.h"

// Channels of the HyperBus (archi/udma/udma_v2.h). A channel runs one transfer and queues another.
#define RECEIVE 0x180u
#define SEND 0x190u
#define OUTSIDE 0x1A0u
#define RUNS (1u << 4)
#define IS_FULL (1u << 5)

#define FLASH_BASE 0x1000000u  // reset value of MEM_CFG4
#define MOST_BYTES 0x10000u    // of a transfer, whose size has 17 bits

static uint32_t reg(uint32_t offset) {
  return *(volatile uint32_t*)(UDMA_BASE + offset);
}

static void set(uint32_t offset, uint32_t value) {
  *(volatile uint32_t*)(UDMA_BASE + offset) = value;
}

static void transfer(uint32_t channel, void* memory, uint32_t outside, uint32_t bytes) {
  set(channel, (uint32_t)memory);
  set(channel + 4, bytes);
  set(OUTSIDE, outside);
  set(channel + 8, RUNS);
}

static void wait_for(uint32_t channel) {
  while ((reg(channel + 8) & RUNS) != 0) {
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
  while (left.bytes > 0 && (reg(RECEIVE + 8) & IS_FULL) == 0) {
    const uint32_t part = smaller(left.bytes, MOST_BYTES);
    transfer(RECEIVE, left.to, left.from, part);
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
  wait_for(RECEIVE);
}

const layer_l3_t layer_l3 = {fetch, advance, layer_l3_wait};

void layer_l3_load(uint32_t flash, uint32_t bytes, uint8_t* buffer, uint32_t buffer_bytes) {
  const uint32_t most = smaller(buffer_bytes & ~3u, MOST_BYTES);
  for (uint32_t at = 0; at < bytes; at += most) {
    const uint32_t part = smaller(bytes - at, most);
    transfer(RECEIVE, buffer, FLASH_BASE + flash + at, part);
    wait_for(RECEIVE);
    transfer(SEND, buffer, at, part);
    wait_for(SEND);
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
