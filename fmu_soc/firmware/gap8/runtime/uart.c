// SPDX-License-Identifier: Apache-2.0
#include "runtime/uart.h"

#include <stdint.h>

#include "runtime/chip.h"
#include "runtime/registers.h"
#include "runtime/soc_events.h"

#define BAUD 115200
#define SETUP_8_BITS 6u
#define SETUP_TRANSMITTER 0x100u
#define SETUP_DIVIDER_SHIFT 16
#define LINE_BYTES 128

static char lines[2][LINE_BYTES];
static unsigned filling;
static unsigned filled;

static volatile unsigned sent = 1;

// Handles the end of a uDMA transfer. This event also ends a sleep in which the clock stayed high for the transmitter.
static void on_sent(void) {
  sent = 1;
}

void uart_start(void) {
  UDMA_CLOCK_GATE |= UDMA_CLOCK_UART;
  UDMA_UART_SETUP = (START_CLOCK_HZ / BAUD - 1) << SETUP_DIVIDER_SHIFT | SETUP_TRANSMITTER | SETUP_8_BITS;
  soc_event_attach(SOC_EVENT_UART_SENT, on_sent);
}

// Returns true until the bits of the last byte are sent. The uDMA transfer ends when the transmitter takes the last
// byte.
bool uart_sends(void) {
  return udma_runs(UDMA_UART_SEND_OFFSET) || (load(UDMA_BASE + UDMA_UART_STATUS_OFFSET) & UDMA_UART_SENDS) != 0;
}

static void send(void) {
  soc_event_wait(&sent);
  sent = 0;
  udma_start(UDMA_UART_SEND_OFFSET, lines[filling], filled);
  filling ^= 1;
  filled = 0;
}

void uart_put(char c) {
  lines[filling][filled++] = c;
  if (c == '\n' || filled == LINE_BYTES) {
    send();
  }
}

void uart_flush(void) {
  if (filled > 0) {
    send();
  }
  soc_event_wait(&sent);
  while (uart_sends()) {
  }
}
