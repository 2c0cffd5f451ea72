// SPDX-License-Identifier: Apache-2.0
// Calls the PID cascade of a crazyflie-firmware checkout. bench/world/firmware_steps.py compiles this file with the
// checkout's sources. Frames and units of the arguments are those of fmu_world. The firmware uses degrees, and its
// pitch is positive nose up.
#include "controller_pid.h"
#include "power_distribution.h"
#include "stabilizer_types.h"

#include <stdbool.h>
#include <string.h>

static const double kDegrees = 57.295779513082323;

void begin(void) {
  controllerPidInit();
}

// state: position, velocity (world), roll, pitch, yaw, body rate. goal: forward and left velocity, yaw rate, altitude.
// command: duty cycles of the four motors. They keep their values between two attitude periods.
void step(const double state[12], const double goal[4], unsigned tick, double command[4]) {
  static control_t control;
  state_t now;
  sensorData_t sensors;
  setpoint_t wanted;
  memset(&now, 0, sizeof now);
  memset(&sensors, 0, sizeof sensors);
  memset(&wanted, 0, sizeof wanted);
  now.position = (point_t){.x = (float)state[0], .y = (float)state[1], .z = (float)state[2]};
  now.velocity = (velocity_t){.x = (float)state[3], .y = (float)state[4], .z = (float)state[5]};
  now.attitude.roll = (float)(kDegrees * state[6]);
  now.attitude.pitch = (float)(-kDegrees * state[7]);
  now.attitude.yaw = (float)(kDegrees * state[8]);
  sensors.gyro.x = (float)(kDegrees * state[9]);
  sensors.gyro.y = (float)(kDegrees * state[10]);
  sensors.gyro.z = (float)(kDegrees * state[11]);
  wanted.mode.x = modeVelocity;
  wanted.mode.y = modeVelocity;
  wanted.mode.z = modeAbs;
  wanted.mode.yaw = modeVelocity;
  wanted.velocity_body = true;
  wanted.velocity.x = (float)goal[0];
  wanted.velocity.y = (float)goal[1];
  wanted.attitudeRate.yaw = (float)(kDegrees * goal[2]);
  wanted.position.z = (float)goal[3];

  controllerPid(&control, &wanted, &sensors, &now, tick);
  motors_thrust_uncapped_t shares;
  motors_thrust_pwm_t capped;
  powerDistribution(&control, &shares);
  powerDistributionCap(&shares, &capped);
  for (int i = 0; i < 4; ++i) command[i] = capped.list[i] / 65535.0;
}
