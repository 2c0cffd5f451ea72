// SPDX-License-Identifier: Apache-2.0
// Driver of the sensor.
#pragma once

#include <stdint.h>

// Attaches the sensor's interrupt. Call once, with interrupts off.
void my_sensor_init(void);

// Measures once and sleeps meanwhile. Returns the value in thousandths of its unit.
int32_t my_sensor_measure(void);

// Sends the result that the firmware computes from the values, in thousandths.
void my_sensor_report(int32_t value);
