// SPDX-License-Identifier: Apache-2.0
// Himax HM01B0 behind the chip's camera device: ask for a picture, sleep until it lies in memory. Pictures go to two
// buffers in turn: one is exposed and read out while the program works on the one before it.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum {
  PICTURE_TAKEN,    // a new picture lies in the buffer
  PICTURE_REFUSED,  // the device refused: buffer too small or not in L2, or asked while busy
  PICTURE_LATE      // no picture until the deadline
} camera_result_t;

typedef struct {
  const uint8_t* pixels;  // grey, row by row from the top left
  int width;              // [px]
  int height;             // [px]
  uint32_t id;            // count of the picture
} picture_t;

// Attaches the interrupt. Call once, with interrupts off.
void camera_init(void);

// Asks for a picture and returns at once; one that is on its way already stays the one asked for. False: refused.
bool camera_ask(void);

// Sleeps until the picture asked for is there or `deadline_ns` has come, after which it is still on its way. Uses the
// timer's alarm. The picture's pixels stay until the one after the next is asked for.
camera_result_t camera_wait(picture_t* picture, int64_t deadline_ns);

// Both at once.
static inline camera_result_t camera_take(picture_t* picture, int64_t deadline_ns) {
  return camera_ask() ? camera_wait(picture, deadline_ns) : PICTURE_REFUSED;
}

#ifdef __cplusplus
}
#endif
