// SPDX-License-Identifier: Apache-2.0
// Sends the characters of print(). This file is for GAP8's UART, which sends a line at a time.
#pragma once

#include "runtime/uart.h"

static inline void put_char(char c) {
  uart_put(c);
}

// Waits until all characters are sent.
static inline void flush_characters(void) {
  uart_flush();
}
