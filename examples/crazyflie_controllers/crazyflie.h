// SPDX-License-Identifier: Apache-2.0
// The interface of a controller from a checkout of crazyflie-firmware. The macro CONTROLLER selects the controller:
// pid, mellinger, brescianini or lee.
#pragma once

#include "stabilizer_types.h"

void crazyflie_init(void);
// Calls the controller with the arguments of the firmware's stabilizer loop. One tick is 1 ms.
void crazyflie_step(control_t* control, const setpoint_t* setpoint, const sensorData_t* sensors, const state_t* state,
                    uint32_t tick);
