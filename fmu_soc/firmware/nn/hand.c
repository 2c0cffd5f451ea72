// SPDX-License-Identifier: Apache-2.0
#include "nn/hand.h"

_Static_assert(NN_HAND_PITCH == NN_PICTURE_PITCH, "nn_hand_row has it as a number");

void nn_hand_row(const uint8_t* at, uint8_t* to, const uint32_t* table, int count);

void nn_hand_shrink_pixels(const uint16_t* columns, const uint8_t* upper, const uint8_t* lower, int8_t* to, int fours);

void nn_hand_shrink(nn_arena_t* arena, const uint8_t* source, int width, int height, const uint16_t* columns, int first,
                    int count, nn_share_t share) {
  const int top = shrink_place(first, height);
  // Each core starts at another column, to avoid conflicts: if `width` is a multiple of 64, a column of all rows is in
  // one bank.
  const int begin = SHRUNK_EDGE / 8 / 4 * 4 * (int)share.core;
  for (int y = first + (int)share.core; y < first + count; y += (int)share.cores) {
    const uint8_t* upper = source + (shrink_place(y, height) - top) * width;
    const uint8_t* lower = upper + width;
    int8_t* to = &arena->picture[(y + 2) * NN_PICTURE_PITCH + 2];
    nn_hand_shrink_pixels(columns + begin, upper, lower, to + begin, (SHRUNK_EDGE - begin) / 4);
    if (begin > 0) {
      nn_hand_shrink_pixels(columns, upper, lower, to, begin / 4);
    }
  }
}

// Fills the table of nn_hand_row() for four channels of the first layer: the words of nn_small_weights_t, the last word
// shifted by two bytes for pixels that are two bytes farther in their word, the bias and the shift.
static void make_table(uint32_t table[4 * NN_HAND_WORDS], const nn_arena_t* arena, int from) {
  const nn_layer_t layer = nn_layer(0);
  for (int c = from; c < from + 4; ++c, table += NN_HAND_WORDS) {
    const uint32_t* words = &arena->small.first[c * NN_FIRST_WORDS];
    for (int i = 0; i < NN_FIRST_WORDS; ++i) {
      table[i] = words[i];
    }
    table[NN_FIRST_WORDS] = words[NN_FIRST_WORDS - 1] << 16;
    table[NN_FIRST_WORDS + 1] = (uint32_t)layer.biases[c];
    table[NN_FIRST_WORDS + 2] = layer.shifts[c];
  }
}

void nn_hand_first(nn_arena_t* arena, nn_share_t share) {
  uint32_t table[4 * NN_HAND_WORDS];  // on the core's stack, in L1
  for (int from = 0; from < NN_CHANNELS_FIRST; from += 4) {
    make_table(table, arena, from);
    // A unit of work is half a row. With whole rows, only two of eight cores would compute the last two of the 42 rows.
    const int parts = 2 * NN_POOLED_EDGE;
    for (int part = (int)share.core; part < parts; part += (int)share.cores) {
      const int y = part / 2;
      const int x = part % 2 * (NN_POOLED_EDGE / 2);
      const uint8_t* at = (const uint8_t*)&arena->picture[4 * y * NN_PICTURE_PITCH + 4 * x];
      uint8_t* to = &arena->pooled[((y + 1) * (NN_POOLED_EDGE + 2) + x + 1) * NN_CHANNELS_FIRST + from];
      nn_hand_row(at, to, table, NN_POOLED_EDGE / 2);
    }
  }
}
