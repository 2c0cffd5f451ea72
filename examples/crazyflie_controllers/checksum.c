// SPDX-License-Identifier: Apache-2.0
// Calls the controller with 4000 random states and set-points. The random generator uses integers, so chip and host get
// the same values. Prints a checksum (FNV-1a) of the bits of all outputs. This file is compiled for the chip and for
// the host.
#include "crazyflie.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static uint32_t random_state = 1;
static uint64_t checksum = 0xcbf29ce484222325U;

// Returns a random number from -size to size. All operations are exact in float.
static float number(float size) {
  random_state = 1664525U * random_state + 1013904223U;
  return size * ((float)(int32_t)(random_state >> 8) / 8388608.0F - 1.0F);
}

static void add(float value) {
  uint32_t bits;
  memcpy(&bits, &value, sizeof bits);
  for (int i = 0; i < 4; ++i) {
    checksum = (checksum ^ (bits >> (8 * i) & 0xffU)) * 0x100000001b3U;
  }
}

static void add_control(const control_t* control) {
  if (control->controlMode == controlModeLegacy) {
    add(control->roll);
    add(control->pitch);
    add(control->yaw);
    add(control->thrust);
    return;
  }
  add(control->thrustSi);
  for (int i = 0; i < 3; ++i) add(control->torque[i]);
}

int main(void) {
  static control_t control;
  static state_t state;
  static sensorData_t sensors;
  static setpoint_t wanted;
  crazyflie_init();
  wanted.mode.x = wanted.mode.y = wanted.mode.z = wanted.mode.yaw = modeAbs;
  for (uint32_t tick = 0; tick < 4000; ++tick) {
    state.position.x = number(1.0F);
    state.position.y = number(1.0F);
    state.position.z = 1.0F + number(0.5F);
    state.velocity.x = number(0.5F);
    state.velocity.y = number(0.5F);
    state.velocity.z = number(0.5F);
    const float x = number(0.2F);
    const float y = number(0.2F);
    const float z = number(0.5F);
    const float norm = 1.0F / sqrtf(1.0F + x * x + y * y + z * z);
    state.attitudeQuaternion.x = norm * x;
    state.attitudeQuaternion.y = norm * y;
    state.attitudeQuaternion.z = norm * z;
    state.attitudeQuaternion.w = norm;
    state.attitude.roll = number(20.0F);
    state.attitude.pitch = number(20.0F);
    state.attitude.yaw = number(170.0F);
    sensors.gyro.x = number(100.0F);
    sensors.gyro.y = number(100.0F);
    sensors.gyro.z = number(100.0F);
    sensors.acc.z = 1.0F + number(0.2F);
    wanted.position.x = number(1.0F);
    wanted.position.y = number(1.0F);
    wanted.position.z = 1.0F + number(0.5F);
    wanted.velocity.x = number(0.5F);
    wanted.velocity.y = number(0.5F);
    wanted.attitude.yaw = number(170.0F);
    wanted.attitudeRate.yaw = number(50.0F);
    crazyflie_step(&control, &wanted, &sensors, &state, tick);
    add_control(&control);
  }
  printf("checksum %08lx%08lx\n", (unsigned long)(checksum >> 32), (unsigned long)(checksum & 0xffffffffU));
  return 0;
}
