// SPDX-License-Identifier: Apache-2.0
// Implements the two speed policies of the paper (examples/paper).
#pragma once

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

// Number of outputs in the paper's moving mean.
#define POLICY_WINDOW 10

// policy_init() sets all fields, which are private.
typedef struct {
  bool adaptive;
  int32_t cruise_um_s;
  int32_t speed_um_s;
  int8_t outputs[POLICY_WINDOW];
  int count;  // number of stored outputs, at most POLICY_WINDOW
  int next;
} policy_t;

// Initialises a policy. The constant policy always returns the cruise speed. The adaptive policy returns the cruise
// speed while the magnitude of the mean of the last ten outputs is at most 0.3. While the mean is larger, each output
// reduces the speed by 0.05 km/h, down to 0. The first speed is `first_um_s`. With fewer than ten outputs, the mean is
// that of all outputs.
void policy_init(policy_t* policy, bool adaptive, int32_t cruise_um_s, int32_t first_um_s);

// Adds the next yaw output of the navigator (127 = 1), and returns the speed [um/s].
int32_t policy_speed_um_s(policy_t* policy, int8_t yaw);

#ifdef __cplusplus
}
#endif
