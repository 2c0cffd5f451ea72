// SPDX-License-Identifier: Apache-2.0
// Where the characters of print() go. Here: GAP8's UART, a line at a time.
#pragma once

#include "runtime/uart.h"

static inline void put_char(char c) {
  uart_put(c);
}

// Waits until all characters are out.
static inline void flush_characters(void) {
  uart_flush();
}
