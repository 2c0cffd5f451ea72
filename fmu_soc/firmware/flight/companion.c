// SPDX-License-Identifier: Apache-2.0
#include "flight/companion.h"

#include "board.h"
#include "drivers/setpoint_frame.h"
#include "drivers/uart.h"
#include "runtime/console.h"

static setpoint_reader_t reader;
static uint32_t last_frame_us;

static void follow(const setpoint_t* setpoint) {
  COMMANDER_MODE = setpoint->mode;
  COMMANDER_VELOCITY_X = (uint32_t)setpoint->velocity_x_um_s;
  COMMANDER_YAW_RATE = (uint32_t)setpoint->yaw_rate_urad_s;
  COMMANDER_ALTITUDE = (uint32_t)setpoint->altitude_um;
  COMMANDER_FRAMES = reader.frames;
  COMMANDER_FRAMES_LOST = reader.lost;
  COMMANDER_SILENT = 0;
}

void companion_update(uint32_t time_us) {
  for (unsigned left = uart_received(); left > 0; --left) {
    setpoint_t setpoint;
    // A valid frame of another program may have an unknown mode.
    if (setpoint_reader_take(&reader, (uint8_t)UART_DATA, &setpoint) && setpoint.mode <= FLIGHT_MODE_LAND) {
      last_frame_us = time_us;
      follow(&setpoint);
    }
  }
  const uint32_t mode = COMMANDER_MODE;
  const int must_hear = mode == FLIGHT_MODE_TAKE_OFF || mode == FLIGHT_MODE_FLY;
  if (must_hear && time_us - last_frame_us > COMPANION_TIMEOUT_MS * 1000U) {
    print("%m s  no set-points for %u ms: landing\n", (int32_t)(time_us / 1000), COMPANION_TIMEOUT_MS);
    COMMANDER_MODE = FLIGHT_MODE_LAND;
    COMMANDER_SILENT = 1;
  }
}
