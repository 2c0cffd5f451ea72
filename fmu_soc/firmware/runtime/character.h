// SPDX-License-Identifier: Apache-2.0
// Where the characters of print() go. Here: boards with our console.
#pragma once

#include <stdint.h>

#include "board.h"

static inline void put_char(char c) {
  CONSOLE_PUTCHAR = (uint8_t)c;
}

// Waits until all characters are out.
static inline void flush_characters(void) {}
