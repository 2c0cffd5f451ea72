// SPDX-License-Identifier: Apache-2.0
// The first layer and the shrinking of the picture, scheduled by hand: same results as nn_fast_first and
// nn_fast_shrink, whose arguments they take. CMakeLists.txt says which programs have them.
#pragma once

#include "nn/shape.h"

// Bytes of a row of the network's picture, and words of a channel in the table that nn_hand_row reads.
#define NN_HAND_PITCH 172
#define NN_HAND_WORDS 10

#ifndef __ASSEMBLER__

#include "nn/fast.h"

void nn_hand_shrink(nn_arena_t* arena, const uint8_t* source, int width, int height, const uint16_t* columns, int first,
                    int count, nn_share_t share);
void nn_hand_first(nn_arena_t* arena, nn_share_t share);

#endif
