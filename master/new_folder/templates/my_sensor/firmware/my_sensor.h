// SPDX-License-Identifier: Apache-2.0
// Declares the driver of the sensor.
#pragma once

#include <stdint.h>

// Attaches the handler of the sensor's interrupt. Call it once, while interrupts are disabled.
void my_sensor_init(void);

// Performs one measurement; the core sleeps meanwhile. Returns the value in thousandths of its unit.
int32_t my_sensor_measure(void);

// Sends the firmware's result, in thousandths of its unit.
void my_sensor_report(int32_t value);
