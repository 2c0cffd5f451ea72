// SPDX-License-Identifier: Apache-2.0
#include "app/policy.h"

// Reduction of the speed by one output, 0.05 km/h.
#define SPEED_STEP_UM_S 13889

void policy_init(policy_t* policy, bool adaptive, int32_t cruise_um_s, int32_t first_um_s) {
  policy->adaptive = adaptive;
  policy->cruise_um_s = cruise_um_s;
  policy->speed_um_s = first_um_s;
  policy->count = 0;
  policy->next = 0;
}

int32_t policy_speed_um_s(policy_t* policy, int8_t yaw) {
  policy->outputs[policy->next] = yaw;
  policy->next = policy->next + 1 < POLICY_WINDOW ? policy->next + 1 : 0;
  if (policy->count < POLICY_WINDOW) {
    ++policy->count;
  }
  int sum = 0;
  for (int i = 0; i < policy->count; ++i) {
    sum += policy->outputs[i];
  }
  // Tests whether |sum / 127 / count| <= 0.3, without a division.
  const int magnitude = sum < 0 ? -sum : sum;
  if (!policy->adaptive || magnitude * 10 <= 3 * 127 * policy->count) {
    policy->speed_um_s = policy->cruise_um_s;
  } else {
    policy->speed_um_s -= SPEED_STEP_UM_S;
    if (policy->speed_um_s < 0) {
      policy->speed_um_s = 0;
    }
  }
  return policy->speed_um_s;
}
