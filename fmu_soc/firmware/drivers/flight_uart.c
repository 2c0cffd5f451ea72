// SPDX-License-Identifier: Apache-2.0
#include "drivers/flight.h"
#include "drivers/setpoint_frame.h"
#include "drivers/uart.h"
#include "runtime/console.h"

static setpoint_t last;
static uint8_t number;

// Reports a transmit FIFO that is too small for a frame. While the UART transmits nothing, the FIFO is empty; a frame
// that does not fit then never fits.
static void report_small_fifo(unsigned places) {
  static bool reported;
  if (reported || (UART_STATUS & UART_STATUS_TRANSMITS) != 0) {
    return;
  }
  reported = true;
  print("the UART's FIFO has %u places, but a frame needs %u: set uart.fifo_depth to %u or more\n", places,
        SETPOINT_FRAME_BYTES, SETPOINT_FRAME_BYTES);
}

void flight_send(const setpoint_t* setpoint) {
  last = *setpoint;
  flight_repeat();
}

void flight_repeat(void) {
  const unsigned places = uart_places();
  if (places < SETPOINT_FRAME_BYTES) {
    ++number;  // the receiver counts the frame as lost
    report_small_fifo(places);
    return;
  }
  uint8_t frame[SETPOINT_FRAME_BYTES];
  setpoint_frame_write(&last, number, frame);
  ++number;
  for (unsigned i = 0; i < SETPOINT_FRAME_BYTES; ++i) {
    UART_DATA = frame[i];
  }
}
