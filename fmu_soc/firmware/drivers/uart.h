// SPDX-License-Identifier: Apache-2.0
// Exchanges bytes with another chip by UART.
#pragma once

#include <stdint.h>

#include "board.h"

#define UART_STATUS_RECEIVED 0xFFU
#define UART_STATUS_PLACES_SHIFT 8
#define UART_STATUS_TRANSMITS (1U << 16)

static inline unsigned uart_received(void) {
  return UART_STATUS & UART_STATUS_RECEIVED;
}
// Returns the number of bytes that the transmit FIFO can still take.
static inline unsigned uart_places(void) {
  return (UART_STATUS >> UART_STATUS_PLACES_SHIFT) & UART_STATUS_RECEIVED;
}
