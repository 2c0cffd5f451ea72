// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

// Executes p.elw. The core sleeps until the event unit returns a value.
static inline uint32_t event_load(uint32_t address) {
  uint32_t value;
  __asm__ volatile(".insn i 0x03, 6, %0, 0(%1)" : "=r"(value) : "r"(address) : "memory");
  return value;
}
