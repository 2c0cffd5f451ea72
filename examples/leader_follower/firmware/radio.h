// SPDX-License-Identifier: Apache-2.0
// Driver of the radio: packets of three words, distances, positions.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#define RADIO_ALL 0

typedef struct {
  int32_t words[3];
} radio_packet_t;

// Sends a packet to node `to`. If `to` is RADIO_ALL, sends it to all nodes.
void radio_send(uint32_t to, const radio_packet_t* packet);

// Stores a received packet in `packet`, and its sender in `from`. Returns false if no packet has arrived since the last
// call. The radio provides one packet per step of the simulation, and only the last packet is kept.
bool radio_receive(radio_packet_t* packet, uint32_t* from);

void radio_request_distance(uint32_t node);

// Stores the measured distance in `distance_mm`. Returns false if there is no new distance.
bool radio_distance(int32_t* distance_mm);

// Stores a position from the positioning system in `x_mm` and `y_mm`. Returns false if there is no new position.
bool radio_position(int32_t* x_mm, int32_t* y_mm);
