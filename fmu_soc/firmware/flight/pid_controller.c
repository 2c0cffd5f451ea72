// SPDX-License-Identifier: Apache-2.0
// Implements a cascade of PID controllers: position -> velocity -> tilt and thrust at 100 Hz; angle -> rate -> rotors
// in each loop.
//
// Gains of angle and rate: Bitcraze, Crazyflie 2.x (platform_defaults_cf2.h, commit 2a18fc29), in radians and fractions
// of the full command. The gains of the velocity have a faster integral.
#include <math.h>

#include "flight/controller.h"

#define POSITION_LOOPS 10  // loops between two position controls

typedef struct {
  float kp;
  float ki;
  float kd;
  float most_integral;  // greatest integral of the error
} gains_t;

typedef struct {
  float integral;
  float last;
} memory_t;

static const gains_t kRate = {0.2186F, 0.4371F, 0.002186F, 0.58F};
static const gains_t kYawRate = {0.1049F, 0.0146F, 0.0F, 2.9F};
static const gains_t kAngle = {6.0F, 3.0F, 0.0F, 0.35F};
static const gains_t kYaw = {6.0F, 1.0F, 0.0F, 6.28F};
static const gains_t kVelocity = {0.436F, 0.15F, 0.0F, 1.5F};
static const gains_t kClimb = {0.3815F, 0.2289F, 0.0F, 1.5F};
static const float kPosition = 1.0F;  // [1/s]
static const float kHeight = 2.0F;
static const float kMostSpeed_m_s = 1.1F;
static const float kMostTilt = 0.35F;  // [rad]
static const float kHoverThrust = 0.549F;
static const float kLeastThrust = 0.305F;
// Low-pass filter of the gyroscope, 80 Hz at 1 kHz: 1 - exp(-2 pi 80 / 1000).
static const float kRateFilter = 0.395F;

static memory_t roll_rate, pitch_rate, yaw_rate, roll, pitch, yaw, forward, left, climb;
static flight_vector_t filtered;
static float wanted_roll, wanted_pitch, thrust;

static float limited(float value, float most) {
  return value < -most ? -most : value > most ? most : value;
}

// Returns the output of a controller. The derivative uses `measured`, so that a step of the desired value causes no
// peak.
static float pid(const gains_t* gains, memory_t* memory, float error, float measured, float dt) {
  memory->integral = limited(memory->integral + error * dt, gains->most_integral);
  const float slope = (measured - memory->last) / dt;
  memory->last = measured;
  return gains->kp * error + gains->ki * memory->integral - gains->kd * slope;
}

void controller_init(void) {}

static void start(const flight_state_t* state) {
  roll_rate = pitch_rate = yaw_rate = roll = pitch = yaw = forward = left = climb = (memory_t){0.0F, 0.0F};
  filtered = state->rate;
  roll_rate.last = filtered.x;
  pitch_rate.last = filtered.y;
}

static void control_position(const flight_goal_t* goal, const flight_state_t* state) {
  const float dt = POSITION_LOOPS * LOOP_PERIOD_S;
  const float wanted_x = goal->velocity.x + limited(kPosition * (goal->position.x - state->position.x), kMostSpeed_m_s);
  const float wanted_y = goal->velocity.y + limited(kPosition * (goal->position.y - state->position.y), kMostSpeed_m_s);
  const float wanted_z = goal->velocity.z + limited(kHeight * (goal->position.z - state->position.z), kMostSpeed_m_s);
  const float error_x = wanted_x - state->velocity.x;
  const float error_y = wanted_y - state->velocity.y;
  const float sin_yaw = sinf(state->yaw);
  const float cos_yaw = cosf(state->yaw);
  // With the nose down, the drone accelerates forward; with the right side down, to the right.
  wanted_pitch = limited(pid(&kVelocity, &forward, cos_yaw * error_x + sin_yaw * error_y, 0.0F, dt), kMostTilt);
  wanted_roll = limited(-pid(&kVelocity, &left, cos_yaw * error_y - sin_yaw * error_x, 0.0F, dt), kMostTilt);
  thrust = kHoverThrust + pid(&kClimb, &climb, wanted_z - state->velocity.z, 0.0F, dt);
  thrust = thrust < kLeastThrust ? kLeastThrust : thrust > 1.0F ? 1.0F : thrust;
}

// Computes the rotors' commands. If a command exceeds the full command, the excess is subtracted from all commands, so
// that the torques do not change.
static void mix(float u_roll, float u_pitch, float u_yaw, float command[ROTORS]) {
  const float r = 0.5F * u_roll;
  const float p = 0.5F * u_pitch;
  command[0] = thrust - r - p - u_yaw;
  command[1] = thrust - r + p + u_yaw;
  command[2] = thrust + r + p - u_yaw;
  command[3] = thrust + r - p + u_yaw;
  float most = 1.0F;
  for (int i = 0; i < ROTORS; ++i) {
    most = command[i] > most ? command[i] : most;
  }
  for (int i = 0; i < ROTORS; ++i) {
    command[i] -= most - 1.0F;
  }
}

void controller_update(const flight_goal_t* goal, const flight_state_t* state, bool first, float command[ROTORS]) {
  const float dt = LOOP_PERIOD_S;
  if (first) {
    start(state);
  }
  filtered.x += kRateFilter * (state->rate.x - filtered.x);
  filtered.y += kRateFilter * (state->rate.y - filtered.y);
  filtered.z += kRateFilter * (state->rate.z - filtered.z);
  if (first || state->tick % POSITION_LOOPS == 0) {
    control_position(goal, state);
  }
  const float roll_speed = pid(&kAngle, &roll, wanted_roll - state->roll, 0.0F, dt);
  const float pitch_speed = pid(&kAngle, &pitch, wanted_pitch - state->pitch, 0.0F, dt);
  const float yaw_speed = goal->yaw_rate + pid(&kYaw, &yaw, goal->yaw - state->yaw, 0.0F, dt);
  const float u_roll = pid(&kRate, &roll_rate, roll_speed - filtered.x, filtered.x, dt);
  const float u_pitch = pid(&kRate, &pitch_rate, pitch_speed - filtered.y, filtered.y, dt);
  const float u_yaw = pid(&kYawRate, &yaw_rate, yaw_speed - filtered.z, filtered.z, dt);
  mix(u_roll, u_pitch, u_yaw, command);
}
