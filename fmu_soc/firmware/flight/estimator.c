// SPDX-License-Identifier: Apache-2.0
// Estimates the state by three observers with fixed gains:
//
//   v' = a + Lv e,  tilt' = rate + bias + Lt e / g,  bias' = Lb e / g     level, for each axis; e = v_flow - v
//   z' = w + L1 e,  w' = a_z + b + L2 e,  b' = L3 e                       height; e = z_range - z
//   yaw' = rate
//
// A tilt error of d causes an acceleration error of g d. Therefore the poles of the velocity error are the solutions of
//
//   s^3 + Lv s^2 + Lt s + Lb = 0
//
// If all three poles are -p, the gains are Lv = 3 p, Lt = 3 p^2 and Lb = p^3.
#include "flight/estimator.h"

#include <math.h>

#include "board.h"

static const float kGravity = 9.80665F;
static const float kTiltPole = 1.5F;  // [1/s]
static const float kHeightPole = 3.0F;
// PMW3901 on the flow deck: 48.8 pixels per radian, 0.1 pixel per count, a sample each 10 ms.
static const float kRadPerCount = 0.1F / 48.8F;
static const float kFlowPeriod_s = 0.01F;
static const uint32_t kFlowPeriod_ms = 10;
static const float kRangePeriod_s = 0.025F;
static const uint32_t kRangePeriod_ms = 25;
static const uint32_t kBarometerPeriod_ms = 40;
// Above this distance, the barometer measures the height.
static const float kLongestRange_m = 3.5F;
// If measured and estimated height differ by more than this, the surface below has an edge.
static const float kEdge_m = 0.25F;
// Slope of the standard atmosphere at the ground: 101325 Pa * 5.25588 * 0.0065 K/m / 288.15 K.
static const float kPascalPerMetre = 12.013F;

static flight_state_t state;
static float forward_m_s;  // velocity along the heading
static float left_m_s;
static float bias_roll;  // added to the measured rate [rad/s]
static float bias_pitch;
static float bias_up;     // added to the measured acceleration [m/s2]
static float surface_m;   // height of the surface below the drone, relative to the ground
static float pitch_turn;  // integral of the rate since the last flow sample [rad]
static float roll_turn;
static float range_m;
static float ground_pressure_pa;

void estimator_init(void) {
  BAROMETER_CONTROL = 1;
}

const flight_state_t* estimator_state(void) {
  return &state;
}

float estimator_range(void) {
  return range_m;
}

static void correct_level(float forward_error, float left_error, float dt) {
  const float velocity_gain = 3.0F * kTiltPole * dt;
  const float tilt_gain = 3.0F * kTiltPole * kTiltPole * dt / kGravity;
  const float bias_gain = kTiltPole * kTiltPole * kTiltPole * dt / kGravity;
  forward_m_s += velocity_gain * forward_error;
  left_m_s += velocity_gain * left_error;
  // With the nose down, the drone accelerates forward; with the right side down, to the right.
  state.pitch += tilt_gain * forward_error;
  state.roll -= tilt_gain * left_error;
  bias_pitch += bias_gain * forward_error;
  bias_roll -= bias_gain * left_error;
}

static void correct_height(float error, float dt) {
  state.position.z += 3.0F * kHeightPole * dt * error;
  state.velocity.z += 3.0F * kHeightPole * kHeightPole * dt * error;
  bias_up += kHeightPole * kHeightPole * kHeightPole * dt * error;
}

// If the flow sensor has a new sample, corrects the velocity and the tilt with it. The flow along each axis is velocity
// / distance minus the body's rotation.
static void use_flow(bool flying) {
  if (DECK_FLOW_SEEN != 0) {
    const float forward = range_m * ((float)(int32_t)DECK_FLOW_X * kRadPerCount + pitch_turn) / kFlowPeriod_s;
    const float left = range_m * ((float)(int32_t)DECK_FLOW_Y * kRadPerCount - roll_turn) / kFlowPeriod_s;
    correct_level(forward - forward_m_s, left - left_m_s, kFlowPeriod_s);
  } else if (!flying) {
    correct_level(-forward_m_s, -left_m_s, kFlowPeriod_s);
  }
  pitch_turn = 0.0F;
  roll_turn = 0.0F;
}

static void use_range(void) {
  range_m = (float)(int32_t)DECK_RANGE * 1e-6F;
  if (range_m > kLongestRange_m) {
    return;
  }
  const float height = range_m * cosf(state.roll) * cosf(state.pitch);
  float error = surface_m + height - state.position.z;
  if (fabsf(error) > kEdge_m) {
    surface_m -= error;
    // A surface within kEdge_m of the ground is the ground.
    if (fabsf(surface_m) < kEdge_m) {
      surface_m = 0.0F;
    }
    error = surface_m + height - state.position.z;
  }
  correct_height(error, kRangePeriod_s);
}

// Processes a sample of the barometer. While the range sensor measures the height, the sample only updates the pressure
// at the ground.
static void use_barometer(void) {
  if ((BAROMETER_STATUS & 1U) == 0) {
    return;
  }
  BAROMETER_STATUS = 1;
  const float pressure_pa = (float)BAROMETER_PRESSURE * 0.01F;
  const float ground_pa = pressure_pa + kPascalPerMetre * state.position.z;
  if (ground_pressure_pa == 0.0F) {
    ground_pressure_pa = ground_pa;
  } else if (range_m <= kLongestRange_m) {
    ground_pressure_pa += 0.02F * (ground_pa - ground_pressure_pa);
  } else {
    const float height = (ground_pressure_pa - pressure_pa) / kPascalPerMetre;
    correct_height(0.2F * (height - state.position.z), (float)kBarometerPeriod_ms * 0.001F);
  }
}

// Converts body rates to rates of roll, pitch and yaw, and forces to the heading frame. Integrates them over `dt`.
static void predict(float dt) {
  const float sin_roll = sinf(state.roll);
  const float cos_roll = cosf(state.roll);
  const float sin_pitch = sinf(state.pitch);
  const float cos_pitch = cosf(state.pitch);
  const flight_vector_t rate = state.rate;
  const flight_vector_t force = state.acceleration;
  const float about = rate.y * sin_roll + rate.z * cos_roll;
  const float yaw_rate = about / cos_pitch;
  const float lift = force.y * sin_roll + force.z * cos_roll;
  const float forward = force.x * cos_pitch + lift * sin_pitch + yaw_rate * left_m_s;
  const float left = force.y * cos_roll - force.z * sin_roll - yaw_rate * forward_m_s;
  const float up = lift * cos_pitch - force.x * sin_pitch - kGravity + bias_up;
  state.roll += (rate.x + yaw_rate * sin_pitch + bias_roll) * dt;
  state.pitch += (rate.y * cos_roll - rate.z * sin_roll + bias_pitch) * dt;
  state.yaw += yaw_rate * dt;
  forward_m_s += forward * dt;
  left_m_s += left * dt;
  state.velocity.z += up * dt;
  state.position.z += state.velocity.z * dt;
  roll_turn += (rate.x + bias_roll) * dt;
  pitch_turn += (rate.y + bias_pitch) * dt;
}

static void turn_to_world(float dt) {
  const float sin_yaw = sinf(state.yaw);
  const float cos_yaw = cosf(state.yaw);
  state.velocity.x = cos_yaw * forward_m_s - sin_yaw * left_m_s;
  state.velocity.y = sin_yaw * forward_m_s + cos_yaw * left_m_s;
  state.position.x += state.velocity.x * dt;
  state.position.y += state.velocity.y * dt;
}

static void report(void) {
  ESTIMATE_ROLL = (uint32_t)(int32_t)(1e6F * state.roll);
  ESTIMATE_PITCH = (uint32_t)(int32_t)(1e6F * state.pitch);
  ESTIMATE_YAW = (uint32_t)(int32_t)(1e6F * state.yaw);
  ESTIMATE_FORWARD_VELOCITY = (uint32_t)(int32_t)(1e6F * forward_m_s);
  ESTIMATE_LEFT_VELOCITY = (uint32_t)(int32_t)(1e6F * left_m_s);
  ESTIMATE_ALTITUDE = (uint32_t)(int32_t)(1e6F * state.position.z);
}

void estimator_update(const imu_sample_t* sample, bool flying) {
  ++state.tick;
  state.acceleration = sample->acceleration;
  state.rate = sample->rate;
  predict(LOOP_PERIOD_S);
  const uint32_t time_ms = sample->time_us / 1000;
  if (time_ms % kRangePeriod_ms == 0) {
    use_range();
  }
  if (time_ms % kFlowPeriod_ms == 0) {
    use_flow(flying);
  }
  if (time_ms % kBarometerPeriod_ms == 0) {
    use_barometer();
  }
  turn_to_world(LOOP_PERIOD_S);
  if (time_ms % kFlowPeriod_ms == 0) {
    report();
  }
}
