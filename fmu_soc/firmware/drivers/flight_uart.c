// SPDX-License-Identifier: Apache-2.0
#include "drivers/flight.h"
#include "drivers/setpoint_frame.h"
#include "drivers/uart.h"

static setpoint_t last;
static uint8_t number;

void flight_send(const setpoint_t* setpoint) {
  last = *setpoint;
  flight_repeat();
}

void flight_repeat(void) {
  if (uart_places() < SETPOINT_FRAME_BYTES) {
    return;
  }
  uint8_t frame[SETPOINT_FRAME_BYTES];
  setpoint_frame_write(&last, number, frame);
  ++number;
  for (unsigned i = 0; i < SETPOINT_FRAME_BYTES; ++i) {
    UART_DATA = frame[i];
  }
}
