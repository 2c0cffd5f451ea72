// SPDX-License-Identifier: Apache-2.0
#include "radio.h"

#include "board.h"

static uint32_t packets_sent;
static uint32_t distances_requested;
static uint32_t packets_seen;
static uint32_t distances_seen;
static uint32_t positions_seen;

static bool is_new(uint32_t count, uint32_t* seen) {
  const bool changed = count != *seen;
  *seen = count;
  return changed;
}

void radio_send(uint32_t to, const radio_packet_t* packet) {
  RADIO_TX_TO = to;
  RADIO_TX_SIZE = sizeof packet->words;
  RADIO_TX_WORD1 = (uint32_t)packet->words[0];
  RADIO_TX_WORD2 = (uint32_t)packet->words[1];
  RADIO_TX_WORD3 = (uint32_t)packet->words[2];
  RADIO_TX_COUNT = ++packets_sent;
  RADIO_COMMIT = 1;
}

bool radio_receive(radio_packet_t* packet, uint32_t* from) {
  uint32_t count = RADIO_RX_COUNT;
  if (!is_new(count, &packets_seen)) {
    return false;
  }
  do {  // repeats until no packet arrives between the reads of the first and the last register
    count = RADIO_RX_COUNT;
    *from = RADIO_RX_FROM;
    packet->words[0] = (int32_t)RADIO_RX_WORD1;
    packet->words[1] = (int32_t)RADIO_RX_WORD2;
    packet->words[2] = (int32_t)RADIO_RX_WORD3;
  } while (RADIO_RX_COUNT != count);
  packets_seen = count;
  return true;
}

void radio_request_distance(uint32_t node) {
  RADIO_RANGING_TO = node;
  RADIO_RANGING_COUNT = ++distances_requested;
  RADIO_COMMIT = 1;
}

bool radio_distance(int32_t* distance_mm) {
  *distance_mm = (int32_t)RADIO_RANGING_DISTANCE;
  return is_new(RADIO_RANGING_DONE, &distances_seen);
}

bool radio_position(int32_t* x_mm, int32_t* y_mm) {
  *x_mm = (int32_t)RADIO_FIX_X;
  *y_mm = (int32_t)RADIO_FIX_Y;
  return is_new(RADIO_FIX_COUNT, &positions_seen);
}
