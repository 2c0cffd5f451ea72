// SPDX-License-Identifier: Apache-2.0
// Prints the characters of print(), on boards with MEbots' console.
#pragma once

#include <stdint.h>

#include "board.h"

static inline void put_char(char c) {
  CONSOLE_PUTCHAR = (uint8_t)c;
}

static inline void flush_characters(void) {}
