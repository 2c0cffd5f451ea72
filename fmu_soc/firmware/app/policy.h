// SPDX-License-Identifier: Apache-2.0
// The paper's two speed policies.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

// The paper averages the last ten outputs of its network.
#define POLICY_WINDOW 10

// policy_init() sets all fields. All of them are private.
typedef struct {
  bool adaptive;
  int32_t cruise_um_s;
  int32_t speed_um_s;
  int8_t outputs[POLICY_WINDOW];
  int count;  // number of stored outputs, at most POLICY_WINDOW
  int next;   // index of the next output
} policy_t;

// Constant policy: always the cruise speed. Adaptive policy: the cruise speed (1 km/h in the paper, the mission's
// default) while the magnitude of the mean of the last ten outputs is at most 0.3. Otherwise 0.05 km/h less at each
// output, not below 0, starting from `first_um_s`. Before there are ten outputs, the mean is that of all outputs.
void policy_init(policy_t* policy, bool adaptive, int32_t cruise_um_s, int32_t first_um_s);

// Adds the navigator's next yaw output (127 = 1), and returns the speed [um/s].
int32_t policy_speed_um_s(policy_t* policy, int8_t yaw);

#ifdef __cplusplus
}
#endif
