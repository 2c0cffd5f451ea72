// SPDX-License-Identifier: Apache-2.0
#include "crazyflie.h"

#include "math3d.h"  // necessary for controller_lee.h

#include "controller_brescianini.h"
#include "controller_lee.h"
#include "controller_mellinger.h"
#include "controller_pid.h"

#define pid 1
#define mellinger 2
#define brescianini 3
#define lee 4

#if CONTROLLER == mellinger
static controllerMellinger_t self;
#elif CONTROLLER == lee
static controllerLee_t self;
#endif

void crazyflie_init(void) {
#if CONTROLLER == pid
  controllerPidInit();
#elif CONTROLLER == mellinger
  controllerMellingerInit(&self);
#elif CONTROLLER == brescianini
  controllerBrescianiniInit();
#elif CONTROLLER == lee
  controllerLeeInit(&self);
#else
#error "CONTROLLER must be pid, mellinger, brescianini or lee"
#endif
}

void crazyflie_step(control_t* control, const setpoint_t* setpoint, const sensorData_t* sensors, const state_t* state,
                    uint32_t tick) {
#if CONTROLLER == pid
  controllerPid(control, setpoint, sensors, state, tick);
#elif CONTROLLER == mellinger
  controllerMellinger(&self, control, setpoint, sensors, state, tick);
#elif CONTROLLER == brescianini
  controllerBrescianini(control, setpoint, sensors, state, tick);
#else
  controllerLee(&self, control, setpoint, sensors, state, tick);
#endif
}
