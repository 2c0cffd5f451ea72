// SPDX-License-Identifier: Apache-2.0
// Estimates the state from IMU, flow sensor, range sensor and barometer.
#pragma once

#include <stdbool.h>

#include "drivers/imu.h"
#include "flight/controller.h"

void estimator_init(void);
// Advances the estimate by one IMU sample. `flying` must be false while the drone is on the ground with its motors off.
void estimator_update(const imu_sample_t* sample, bool flying);
const flight_state_t* estimator_state(void);
// Returns the last reading of the range sensor [m].
float estimator_range(void);
