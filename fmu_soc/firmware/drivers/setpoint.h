// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

typedef struct {
  uint32_t mode;            // FLIGHT_MODE_...
  int32_t velocity_x_um_s;  // forward
  int32_t yaw_rate_urad_s;  // positive = left
  int32_t altitude_um;      // above the ground
} setpoint_t;
