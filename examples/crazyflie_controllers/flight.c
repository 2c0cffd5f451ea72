// SPDX-License-Identifier: Apache-2.0
// Implements flight/controller.h with the controller of crazyflie.c. Converts state and goal to the firmware's units
// (degrees, g; the pitch of `attitude` is positive with the nose up). Uses the firmware's own power distribution.
// Compensates the battery voltage as the firmware does.
#include <math.h>
#include <string.h>

#include "board.h"
#include "crazyflie.h"
#include "flight/controller.h"
#include "platform_defaults.h"
#include "power_distribution.h"

static const float kDegrees = 57.2957795F;
static control_t control;

void controller_init(void) {
  crazyflie_init();
}

static quaternion_t quaternion(float roll, float pitch, float yaw) {
  const float cr = cosf(0.5F * roll);
  const float sr = sinf(0.5F * roll);
  const float cp = cosf(0.5F * pitch);
  const float sp = sinf(0.5F * pitch);
  const float cy = cosf(0.5F * yaw);
  const float sy = sinf(0.5F * yaw);
  quaternion_t q;
  q.w = cr * cp * cy + sr * sp * sy;
  q.x = sr * cp * cy - cr * sp * sy;
  q.y = cr * sp * cy + sr * cp * sy;
  q.z = cr * cp * sy - sr * sp * cy;
  return q;
}

static float wrapped_degrees(float yaw) {
  const float turns = roundf(yaw / 6.28318531F);
  return kDegrees * (yaw - 6.28318531F * turns);
}

// Returns the duty cycle for a share of the greatest thrust at this voltage, as the firmware's motor driver does. The
// motor voltage is the root of the driver's cubic of thrust over voltage, found by Newton's method.
static float compensated(float share, float supply_v) {
  const float thrust = THRUST_MAX * share;
  if (thrust < THRUST_MIN || supply_v < 2.0F) return 0.0F;
  float v = 4.0F;
  for (int i = 0; i < 8; ++i) {
    const float at_v = VMOTOR2THRUST0 + v * (VMOTOR2THRUST1 + v * (VMOTOR2THRUST2 + v * VMOTOR2THRUST3));
    const float slope = VMOTOR2THRUST1 + v * (2.0F * VMOTOR2THRUST2 + v * 3.0F * VMOTOR2THRUST3);
    v -= (at_v - thrust) / slope;
  }
  return v / supply_v;
}

void controller_update(const flight_goal_t* goal, const flight_state_t* state, bool first, float command[ROTORS]) {
  static state_t now;
  static sensorData_t sensors;
  static setpoint_t wanted;
  if (first) memset(&control, 0, sizeof control);
  now.position.x = state->position.x;
  now.position.y = state->position.y;
  now.position.z = state->position.z;
  now.velocity.x = state->velocity.x;
  now.velocity.y = state->velocity.y;
  now.velocity.z = state->velocity.z;
  now.attitude.roll = kDegrees * state->roll;
  now.attitude.pitch = -kDegrees * state->pitch;
  now.attitude.yaw = wrapped_degrees(state->yaw);
  now.attitudeQuaternion = quaternion(state->roll, state->pitch, state->yaw);
  sensors.gyro.x = kDegrees * state->rate.x;
  sensors.gyro.y = kDegrees * state->rate.y;
  sensors.gyro.z = kDegrees * state->rate.z;
  sensors.acc.x = state->acceleration.x / 9.80665F;
  sensors.acc.y = state->acceleration.y / 9.80665F;
  sensors.acc.z = state->acceleration.z / 9.80665F;
  wanted.mode.x = wanted.mode.y = wanted.mode.z = wanted.mode.yaw = modeAbs;
  wanted.position.x = goal->position.x;
  wanted.position.y = goal->position.y;
  wanted.position.z = goal->position.z;
  wanted.velocity.x = goal->velocity.x;
  wanted.velocity.y = goal->velocity.y;
  wanted.velocity.z = goal->velocity.z;
  wanted.attitude.yaw = wrapped_degrees(goal->yaw);
  wanted.attitudeRate.yaw = kDegrees * goal->yaw_rate;

  crazyflie_step(&control, &wanted, &sensors, &now, state->tick);
  motors_thrust_uncapped_t shares;
  motors_thrust_pwm_t capped;
  powerDistribution(&control, &shares);
  powerDistributionCap(&shares, &capped);
  // Filters the voltage, because the firmware receives it in slow messages of its power manager. A fast reaction to the
  // voltage sag would increase the sag.
  static float supply_v;
  const float measured_v = 0.001F * (float)BATTERY_VOLTAGE;
  supply_v = first ? measured_v : supply_v + 0.005F * (measured_v - supply_v);
  for (int i = 0; i < ROTORS; ++i) command[i] = compensated((float)capped.list[i] / 65535.0F, supply_v);
}
