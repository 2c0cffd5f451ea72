// SPDX-License-Identifier: Apache-2.0
// Prints the characters of print(). This file is for boards with MEbots' console.
#pragma once

#include <stdint.h>

#include "board.h"

static inline void put_char(char c) {
  CONSOLE_PUTCHAR = (uint8_t)c;
}

// Waits until all characters are printed.
static inline void flush_characters(void) {}
