// SPDX-License-Identifier: Apache-2.0
// Kernels scheduled by hand: the first layer, and the reduction of the picture. Arguments and results are those of
// nn_fast_first() and nn_fast_shrink().
#pragma once

#include "nn/shape.h"

// Bytes of a row of the network's picture, and words per channel in the table of nn_hand_row().
#define NN_HAND_PITCH 172
#define NN_HAND_WORDS 10

#ifndef __ASSEMBLER__

#include "nn/fast.h"

void nn_hand_shrink(nn_arena_t* arena, const uint8_t* source, int width, int height, const uint16_t* columns, int first,
                    int count, nn_share_t share);
void nn_hand_first(nn_arena_t* arena, nn_share_t share);

#endif
