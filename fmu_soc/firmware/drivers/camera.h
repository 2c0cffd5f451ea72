// SPDX-License-Identifier: Apache-2.0
// Himax HM01B0 behind the chip's camera device: ask for a picture, sleep until it lies in memory.
#pragma once

#include <stdint.h>

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

// Names the buffer and attaches the interrupt. Call once, with interrupts off.
void camera_init(void);

// Takes a picture and sleeps until it is there or `deadline_ns` has come. Uses the timer's alarm.
camera_result_t camera_take(picture_t* picture, int64_t deadline_ns);
