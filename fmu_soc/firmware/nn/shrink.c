// SPDX-License-Identifier: Apache-2.0
#include "nn/shrink.h"

void shrink_columns(int width, uint16_t columns[SHRUNK_EDGE]) {
  for (int x = 0; x < SHRUNK_EDGE; ++x) {
    columns[x] = (uint16_t)shrink_place(x, width);
  }
}

void shrink_row(const uint8_t* upper, int width, const uint16_t columns[SHRUNK_EDGE], int8_t row[SHRUNK_EDGE]) {
  const uint8_t* lower = upper + width;
  for (int x = 0; x < SHRUNK_EDGE; ++x) {
    const int at = columns[x];
    row[x] = (int8_t)(((upper[at] + upper[at + 1] + lower[at] + lower[at + 1] + 2) >> 2) - 128);
  }
}
