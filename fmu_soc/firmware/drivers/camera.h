// SPDX-License-Identifier: Apache-2.0
// Requests pictures of an HM01B0 from the chip's camera device. With two buffers, the next picture is exposed and read
// out while the program works on the last picture.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum {
  PICTURE_TAKEN,
  // The device refused the request: the buffer is too small or not in L2, or the device was busy.
  PICTURE_REFUSED,
  PICTURE_LATE  // no picture has arrived before the deadline
} camera_result_t;

typedef struct {
  const uint8_t* pixels;  // grey levels, row by row from the top left
  int width;              // [px]
  int height;             // [px]
  uint32_t id;            // number of the picture
} picture_t;

// Attaches the camera's interrupt. Must be called once, with interrupts off.
void camera_init(void);

// Requests a picture and returns at once. If a request is already open, has no effect. If the device refuses the
// request, returns false.
bool camera_ask(void);

// Sleeps until the requested picture has arrived, or until `deadline_ns`. At the deadline, the request stays open. Uses
// the timer's alarm. The pixels stay valid during the next request, and become invalid at the request after that.
camera_result_t camera_wait(picture_t* picture, int64_t deadline_ns);

static inline camera_result_t camera_take(picture_t* picture, int64_t deadline_ns) {
  return camera_ask() ? camera_wait(picture, deadline_ns) : PICTURE_REFUSED;
}

#ifdef __cplusplus
}
#endif
