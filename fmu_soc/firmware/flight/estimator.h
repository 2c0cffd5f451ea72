// SPDX-License-Identifier: Apache-2.0
// Estimates the state from IMU, flow sensor, range sensor and barometer.
#pragma once

#include <stdbool.h>

#include "drivers/imu.h"
#include "flight/controller.h"

void estimator_init(void);
// Advances by one sample of the IMU. `flying` is false while the drone stands with its motors off.
void estimator_update(const imu_sample_t* sample, bool flying);
const flight_state_t* estimator_state(void);
// The last reading of the range sensor [m].
float estimator_range(void);
