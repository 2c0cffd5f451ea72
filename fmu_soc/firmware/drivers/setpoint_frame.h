// SPDX-License-Identifier: Apache-2.0
// Encodes set-points as a frame of bytes, for a line that may lose or garble bytes:
//
//   mark 0xA5, number, mode, forward velocity, yaw rate, altitude, checksum
//
// Number and mode have one byte each. Velocity, yaw rate and altitude have four bytes each, the checksum has two. The
// least significant byte comes first. The number counts frames, modulo 256. The checksum is CRC-16/CCITT-FALSE
// (polynomial 0x1021, start value 0xFFFF) of all bytes before it.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "drivers/setpoint.h"

#ifdef __cplusplus
extern "C" {
#endif

#define SETPOINT_FRAME_BYTES 17

void setpoint_frame_write(const setpoint_t* setpoint, uint8_t number, uint8_t frame[SETPOINT_FRAME_BYTES]);

// Finds valid frames among received bytes. All fields must initially be zero.
typedef struct {
  uint8_t bytes[SETPOINT_FRAME_BYTES];  // received bytes, starting with a mark
  unsigned count;
  uint32_t frames;      // valid frames
  uint32_t lost;        // missing frames, from the numbers of the valid frames
  uint8_t next_number;  // expected number of the next frame
} setpoint_reader_t;

// Processes a received byte. If the byte completes a valid frame, sets `setpoint` and returns true.
bool setpoint_reader_take(setpoint_reader_t* reader, uint8_t byte, setpoint_t* setpoint);

uint16_t setpoint_frame_checksum(const uint8_t* bytes, unsigned count);

#ifdef __cplusplus
}
#endif
