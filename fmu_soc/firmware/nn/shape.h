// SPDX-License-Identifier: Apache-2.0
// Selects the network: the navigator network or, with NN_SIGHT, the sight network. Both have the same layers, but
// different numbers of channels and outputs.
#pragma once

#ifdef NN_SIGHT
#define NN_CHANNELS_FIRST 8
#define NN_CHANNELS_SECOND 8
#define NN_OUTPUTS 4  // yaw, rise, size and visible; see app/sight.h
#else
#define NN_CHANNELS_FIRST 4
#define NN_CHANNELS_SECOND 4
#define NN_OUTPUTS 1  // yaw
#endif
#define NN_CHANNELS_THIRD 16
#define NN_CHANNELS_FOURTH 32
