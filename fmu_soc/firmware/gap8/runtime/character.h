// SPDX-License-Identifier: Apache-2.0
// Sends the characters of print() to GAP8's UART, line by line.
#pragma once

#include "runtime/uart.h"

static inline void put_char(char c) {
  uart_put(c);
}

static inline void flush_characters(void) {
  uart_flush();
}
