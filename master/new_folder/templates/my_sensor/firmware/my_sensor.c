// SPDX-License-Identifier: Apache-2.0
#include "my_sensor.h"

#include "board.h"
#include "runtime/interrupt.h"

static volatile uint32_t ready;

static void on_ready(void) {
  MY_SENSOR_STATUS = MY_SENSOR_STATUS_READY;
  ready = 1;
}

void my_sensor_init(void) {
  interrupt_attach(MY_SENSOR_INTERRUPT, on_ready);
}

int32_t my_sensor_measure(void) {
  ready = 0;
  MY_SENSOR_COMMAND = MY_SENSOR_OPCODE_START;
  while (ready == 0) {
    sleep_until_interrupt();
  }
  return (int32_t)MY_SENSOR_VALUE;
}

void my_sensor_report(int32_t value) {
  MY_SENSOR_REPORT = (uint32_t)value;
}
