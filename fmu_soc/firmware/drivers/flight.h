// SPDX-License-Identifier: Apache-2.0
// Accesses the flight controller, the battery gauge and the parameters of the mission.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "board.h"
#include "drivers/setpoint.h"

#ifdef UART_DATA
// Sends the set-points in a frame by UART (drivers/flight_uart.c).
void flight_send(const setpoint_t* setpoint);
// Sends the last set-points again, because a frame may have been lost.
void flight_repeat(void);
#else
static inline void flight_send(const setpoint_t* setpoint) {
  (void)setpoint;
}
static inline void flight_repeat(void) {}
#endif

// Sends all set-points at once: to the FMU's variables, and by UART if the board has one.
static inline void flight_command(const setpoint_t* setpoint) {
  FLIGHT_MODE = setpoint->mode;
  FLIGHT_VELOCITY_X = (uint32_t)setpoint->velocity_x_um_s;
  FLIGHT_VELOCITY_Y = 0;
  FLIGHT_YAW_RATE = (uint32_t)setpoint->yaw_rate_urad_s;
  FLIGHT_ALTITUDE = (uint32_t)setpoint->altitude_um;
  FLIGHT_COMMIT = 1;
  flight_send(setpoint);
}

static inline uint32_t flight_phase(void) {
  return FLIGHT_PHASE;
}
static inline int32_t flight_range_um(void) {
  return (int32_t)FLIGHT_RANGE;
}
static inline int32_t flight_forward_velocity_um_s(void) {
  return (int32_t)FLIGHT_FORWARD_VELOCITY;
}
static inline int32_t flight_yaw_urad(void) {
  return (int32_t)FLIGHT_YAW;
}

// Returns true if the world has reported that the drone has crossed the gate.
static inline bool flight_gate_crossed(void) {
  return FLIGHT_GATE_CROSSED != 0;
}

static inline uint32_t battery_voltage_mv(void) {
  return BATTERY_VOLTAGE;
}
static inline uint32_t battery_charge_ppm(void) {
  return BATTERY_STATE_OF_CHARGE;
}
