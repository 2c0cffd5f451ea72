// SPDX-License-Identifier: Apache-2.0
// One of the four controllers of a crazyflie-firmware checkout, chosen by the macro CONTROLLER: pid, mellinger,
// brescianini or lee.
#pragma once

#include "stabilizer_types.h"

void crazyflie_init(void);
// Calls the controller with what the firmware's stabilizer loop would pass; one tick is 1 ms.
void crazyflie_step(control_t* control, const setpoint_t* setpoint, const sensorData_t* sensors, const state_t* state,
                    uint32_t tick);
