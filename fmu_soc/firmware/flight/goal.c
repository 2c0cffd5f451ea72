// SPDX-License-Identifier: Apache-2.0
#include "flight/goal.h"

#include <math.h>

#include "board.h"

static const float kClimb_m_s = 0.5F;
static const float kDescent_m_s = 0.3F;
// Greatest distance of the desired position from the drone. If the drone cannot follow, the desired position stops.
static const float kLeash_m = 0.5F;
// Below this distance to the ground, a landing drone switches its motors off.
static const float kTouchDown_m = 0.05F;

static flight_goal_t goal;
static bool running;
static bool landed;

const flight_goal_t* goal_now(void) {
  return &goal;
}

static float metres(uint32_t micro) {
  return 1e-6F * (float)(int32_t)micro;
}

static float limited(float value, float least, float most) {
  return value < least ? least : value > most ? most : value;
}

static void start(const flight_state_t* state) {
  goal.position = state->position;
  goal.velocity = (flight_vector_t){0.0F, 0.0F, 0.0F};
  goal.yaw = state->yaw;
  goal.yaw_rate = 0.0F;
  running = true;
}

static void move_level(const flight_state_t* state, uint32_t mode) {
  float forward = 0.0F;
  float left = 0.0F;
  goal.yaw_rate = 0.0F;
  if (mode == FLIGHT_MODE_FLY) {
    forward = metres(COMMANDER_VELOCITY_X);
    left = metres(COMMANDER_VELOCITY_Y);
    goal.yaw_rate = metres(COMMANDER_YAW_RATE);
  }
  goal.yaw += goal.yaw_rate * LOOP_PERIOD_S;
  const float sin_yaw = sinf(state->yaw);
  const float cos_yaw = cosf(state->yaw);
  goal.velocity.x = cos_yaw * forward - sin_yaw * left;
  goal.velocity.y = sin_yaw * forward + cos_yaw * left;
  goal.position.x = limited(goal.position.x + goal.velocity.x * LOOP_PERIOD_S, state->position.x - kLeash_m,
                            state->position.x + kLeash_m);
  goal.position.y = limited(goal.position.y + goal.velocity.y * LOOP_PERIOD_S, state->position.y - kLeash_m,
                            state->position.y + kLeash_m);
}

static void move_up(uint32_t mode) {
  const float down = kDescent_m_s * LOOP_PERIOD_S;
  const float up = kClimb_m_s * LOOP_PERIOD_S;
  const float wanted = mode == FLIGHT_MODE_LAND ? -1.0F : metres(COMMANDER_ALTITUDE);
  const float change = limited(wanted - goal.position.z, -down, up);
  goal.position.z += change;
  goal.velocity.z = change / LOOP_PERIOD_S;
}

bool goal_update(const flight_state_t* state, float range_m) {
  const uint32_t mode = COMMANDER_MODE;
  const bool lands = mode == FLIGHT_MODE_LAND;
  if (!lands) {
    landed = false;
  } else if (running && range_m < kTouchDown_m) {
    landed = true;
  }
  if (mode == FLIGHT_MODE_OFF || landed || (lands && !running)) {
    running = false;
    return false;
  }
  if (!running) {
    start(state);
  }
  move_level(state, mode);
  move_up(mode);
  return true;
}
