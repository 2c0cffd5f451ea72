// SPDX-License-Identifier: Apache-2.0
// Driver of the radio: packets of three words, distances, positions.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#define RADIO_ALL 0

typedef struct {
  int32_t words[3];
} radio_packet_t;

// Sends a packet to a node, or to all.
void radio_send(uint32_t to, const radio_packet_t* packet);

// Takes a received packet. Returns false if none arrived since the last call. The radio provides one packet per step of
// the simulation. A program that calls this function less often gets the last packet.
bool radio_receive(radio_packet_t* packet, uint32_t* from);

// Requests the distance to a node.
void radio_request_distance(uint32_t node);

// Takes a measured distance [mm]. Returns false if none is new.
bool radio_distance(int32_t* distance_mm);

// Takes a position from outside [mm]. Returns false if none is new.
bool radio_position(int32_t* x_mm, int32_t* y_mm);
