// SPDX-License-Identifier: Apache-2.0
// Declares the interface of a flight controller. To write your own controller, define the two functions at the end of
// this file in a C file. main.c reads the sensors, estimates the state, follows the set-points and sets the rotors.
//
// Frames: in the world, x is the drone's heading at the start, y points left, and z points up. The origin is on the
// ground where the drone started. In the body, x points forward, y left, z up. Angles are right-handed: roll about x
// (positive = right side down), pitch about y (positive = nose down), yaw about z (positive = left).
#pragma once

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define ROTORS 4
// Period of the loop [s] and [ms].
#define LOOP_PERIOD_S 0.001F
#define LOOP_PERIOD_MS 1

typedef struct {
  float x;
  float y;
  float z;
} flight_vector_t;

typedef struct {
  uint32_t tick;             // loops since the start
  flight_vector_t position;  // [m]
  flight_vector_t velocity;  // [m/s], world frame
  float roll;                // [rad]
  float pitch;
  float yaw;                     // continuous: a full turn to the left adds 2 pi
  flight_vector_t rate;          // angular velocity in the body frame [rad/s]
  flight_vector_t acceleration;  // specific force in the body frame [m/s2]
} flight_state_t;

// The desired state, which moves with the set-points.
typedef struct {
  flight_vector_t position;  // [m]
  flight_vector_t velocity;  // [m/s], world frame
  float yaw;                 // [rad], continuous
  float yaw_rate;            // [rad/s]
} flight_goal_t;

// Called once at the start.
void controller_init(void);

// Called in each loop while the motors are on. `first` is true in the first loop of a flight. Must set `command` to
// each motor's fraction of the full command: front right, rear right, rear left, front left. Values are limited to 0 to
// 1.
void controller_update(const flight_goal_t* goal, const flight_state_t* state, bool first, float command[ROTORS]);

#ifdef __cplusplus
}
#endif
