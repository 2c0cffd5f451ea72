// SPDX-License-Identifier: Apache-2.0
// Requests twenty distances from the range finder, sleeps during each measurement, and reports each distance. Then
// sends an invalid command. The exit code is 0 if the range finder refuses this command.
#include "board.h"
#include "runtime/console.h"
#include "runtime/interrupt.h"

#define MEASUREMENTS 20

static volatile uint32_t measured;

static void on_ready(void) {
  RANGE_FINDER_STATUS = RANGE_FINDER_STATUS_READY;
  ++measured;
}

int main(void) {
  interrupt_attach(RANGE_FINDER_INTERRUPT, on_ready);
  for (uint32_t count = 1; count <= MEASUREMENTS; ++count) {
    RANGE_FINDER_COMMAND = RANGE_FINDER_OPCODE_START;
    while (measured < count) {
      sleep_until_interrupt();
    }
    const uint32_t distance_mm = RANGE_FINDER_DISTANCE;
    RANGE_FINDER_REPORT = distance_mm;
    print("distance %u mm\n", (unsigned)distance_mm);
  }
  RANGE_FINDER_COMMAND = 99;  // an invalid command
  return (RANGE_FINDER_STATUS & RANGE_FINDER_STATUS_REFUSED) != 0 ? 0 : 1;
}
