// SPDX-License-Identifier: Apache-2.0
#include "drivers/setpoint_frame.h"

#define MARK 0xA5U
#define CHECKED_BYTES (SETPOINT_FRAME_BYTES - 2)

uint16_t setpoint_frame_checksum(const uint8_t* bytes, unsigned count) {
  uint16_t sum = 0xFFFF;
  for (unsigned i = 0; i < count; ++i) {
    sum ^= (uint16_t)(bytes[i] << 8);
    for (int bit = 0; bit < 8; ++bit) {
      sum = (uint16_t)((sum & 0x8000U) != 0 ? (sum << 1) ^ 0x1021 : sum << 1);
    }
  }
  return sum;
}

static void write_word(uint8_t* bytes, uint32_t word) {
  for (int i = 0; i < 4; ++i) {
    bytes[i] = (uint8_t)(word >> (8 * i));
  }
}

static int32_t read_word(const uint8_t* bytes) {
  uint32_t word = 0;
  for (int i = 0; i < 4; ++i) {
    word |= (uint32_t)bytes[i] << (8 * i);
  }
  return (int32_t)word;
}

void setpoint_frame_write(const setpoint_t* setpoint, uint8_t number, uint8_t frame[SETPOINT_FRAME_BYTES]) {
  frame[0] = MARK;
  frame[1] = number;
  frame[2] = (uint8_t)setpoint->mode;
  write_word(frame + 3, (uint32_t)setpoint->velocity_x_um_s);
  write_word(frame + 7, (uint32_t)setpoint->yaw_rate_urad_s);
  write_word(frame + 11, (uint32_t)setpoint->altitude_um);
  const uint16_t sum = setpoint_frame_checksum(frame, CHECKED_BYTES);
  frame[CHECKED_BYTES] = (uint8_t)sum;
  frame[CHECKED_BYTES + 1] = (uint8_t)(sum >> 8);
}

static bool is_valid(const uint8_t* frame) {
  const uint16_t sum = setpoint_frame_checksum(frame, CHECKED_BYTES);
  return frame[CHECKED_BYTES] == (uint8_t)sum && frame[CHECKED_BYTES + 1] == (uint8_t)(sum >> 8);
}

// Removes bytes, at least one, until the first byte is a mark.
static void find_next_mark(setpoint_reader_t* reader) {
  unsigned first = 1;
  while (first < reader->count && reader->bytes[first] != MARK) {
    ++first;
  }
  for (unsigned i = first; i < reader->count; ++i) {
    reader->bytes[i - first] = reader->bytes[i];
  }
  reader->count -= first;
}

bool setpoint_reader_take(setpoint_reader_t* reader, uint8_t byte, setpoint_t* setpoint) {
  reader->bytes[reader->count] = byte;
  ++reader->count;
  if (reader->bytes[0] != MARK) {
    reader->count = 0;
    return false;
  }
  if (reader->count < SETPOINT_FRAME_BYTES) {
    return false;
  }
  if (!is_valid(reader->bytes)) {
    find_next_mark(reader);
    return false;
  }
  const uint8_t number = reader->bytes[1];
  reader->lost += reader->frames == 0 ? 0U : (uint8_t)(number - reader->next_number);
  reader->next_number = (uint8_t)(number + 1);
  ++reader->frames;
  reader->count = 0;
  setpoint->mode = reader->bytes[2];
  setpoint->velocity_x_um_s = read_word(reader->bytes + 3);
  setpoint->yaw_rate_urad_s = read_word(reader->bytes + 7);
  setpoint->altitude_um = read_word(reader->bytes + 11);
  return true;
}
