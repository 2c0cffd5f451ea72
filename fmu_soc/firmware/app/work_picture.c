// SPDX-License-Identifier: Apache-2.0
#include "app/work_picture.h"

#include <stddef.h>

#define LEAST_EDGE 64
#define MOST_REDUCTION 4

// Computes one row of the integral image from a row of blocks, which starts at `block_row`. `reduction` must be a
// constant in each call, so that the compiler unrolls the sum over a block.
static inline __attribute__((always_inline)) void sum_row(const uint32_t* above, uint32_t* row,
                                                          const uint8_t* block_row, int blocks, int pitch,
                                                          int reduction) {
  // The mean over a block is rounded, because half the number of pixels is added before the division.
  const uint32_t area = (uint32_t)(reduction * reduction);
  uint32_t sum = 0;
  row[0] = 0;
  for (int x = 0; x < blocks; ++x) {
    uint32_t block = area / 2;
#pragma GCC unroll 4
    for (int i = 0; i < reduction; ++i) {
#pragma GCC unroll 4
      for (int j = 0; j < reduction; ++j) {
        block += block_row[i * pitch + j];
      }
    }
    sum += block / area;
    row[x + 1] = above[x + 1] + sum;
    block_row += reduction;
  }
}

bool work_picture_make(work_picture_t* work, const uint8_t* frame, int width, int height) {
  if (width < LEAST_EDGE || height < LEAST_EDGE) {
    return false;
  }
  const int longest = width > height ? width : height;
  const int reduction = (longest + WORK_MAX - 1) / WORK_MAX;
  if (reduction > MOST_REDUCTION) {
    return false;
  }
  work->width = width / reduction;
  work->height = height / reduction;
  work->reduction = reduction;

  const ptrdiff_t pitch = work->width + 1;
  for (int x = 0; x < pitch; ++x) {
    work->integral[x] = 0;
  }
  for (int y = 0; y < work->height; ++y) {
    const uint32_t* above = &work->integral[y * pitch];
    uint32_t* row = &work->integral[(y + 1) * pitch];
    const uint8_t* blocks = &frame[(ptrdiff_t)y * reduction * width];
    switch (reduction) {
      case 1:
        sum_row(above, row, blocks, work->width, width, 1);
        break;
      case 2:
        sum_row(above, row, blocks, work->width, width, 2);
        break;
      case 3:
        sum_row(above, row, blocks, work->width, width, 3);
        break;
      default:
        sum_row(above, row, blocks, work->width, width, 4);
        break;
    }
  }
  return true;
}
