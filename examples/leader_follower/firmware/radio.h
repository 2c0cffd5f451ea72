// SPDX-License-Identifier: Apache-2.0
// Driver of the radio: packets of three words, distances, positions.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#define RADIO_ALL 0

typedef struct {
  int32_t words[3];
} radio_packet_t;

// Sends a packet to a node, or to all nodes.
void radio_send(uint32_t to, const radio_packet_t* packet);

// Copies a received packet to `packet`, and its sender to `from`. Returns false if no packet has arrived since the last
// call. The radio provides one packet per step of the simulation. A program that calls this function less often
// receives only the last packet.
bool radio_receive(radio_packet_t* packet, uint32_t* from);

// Requests a measurement of the distance to a node.
void radio_request_distance(uint32_t node);

// Stores the measured distance [mm] in `distance_mm`. Returns false if there is no new distance.
bool radio_distance(int32_t* distance_mm);

// Stores a position from the positioning system [mm] in `x_mm` and `y_mm`. Returns false if there is no new position.
bool radio_position(int32_t* x_mm, int32_t* y_mm);
