// SPDX-License-Identifier: Apache-2.0
// Loads the weights of a network from HyperRAM.
#pragma once

#include "kernels/layer.h"

extern const layer_l3_t layer_l3;

// Copies the weights from address `flash` of the HyperFlash to the start of the HyperRAM, through a buffer in L2.
void layer_l3_load(uint32_t flash, uint32_t bytes, uint8_t* buffer, uint32_t buffer_bytes);
