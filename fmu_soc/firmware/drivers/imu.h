// SPDX-License-Identifier: Apache-2.0
// Drives an IMU that has a FIFO and an interrupt.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "flight/controller.h"

typedef struct {
  uint32_t time_us;              // time since reset
  flight_vector_t acceleration;  // specific force [m/s2]
  flight_vector_t rate;          // [rad/s]
} imu_sample_t;

// Starts measurements with a period of `period_us`. Must be called once, with interrupts off.
void imu_init(uint32_t period_us);
// Sleeps until the FIFO contains a sample, and removes the oldest sample. Returns the number of remaining samples.
unsigned imu_wait(imu_sample_t* sample);
