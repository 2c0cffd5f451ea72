// SPDX-License-Identifier: Apache-2.0
#include "drivers/camera.h"

#include "board.h"
#include "drivers/timer.h"
#include "runtime/interrupt.h"

#define CONTROL_TAKE 1U
#define STATUS_BUSY 1U
#define STATUS_READY 2U
#define STATUS_REFUSED 4U

// The sensor's largest picture.
#define BUFFER_BYTES (324 * 324)

static uint8_t buffer[BUFFER_BYTES] __attribute__((aligned(4), section(".noinit.camera")));
// STATUS bits that the interrupt brought.
static volatile uint32_t outcome;

// A picture is there, or one was dropped since it does not fit the buffer.
static void on_camera(void) {
  const uint32_t status = CAMERA_STATUS & (STATUS_READY | STATUS_REFUSED);
  CAMERA_STATUS = status;  // drops the request
  outcome |= status;
}

void camera_init(void) {
  CAMERA_BUFFER = (uint32_t)(uintptr_t)buffer;
  CAMERA_BUFFER_SIZE = BUFFER_BYTES;
  interrupt_attach(CAMERA_INTERRUPT, on_camera);
}

camera_result_t camera_take(picture_t* picture, int64_t deadline_ns) {
  outcome = 0;
  if ((CAMERA_STATUS & STATUS_BUSY) == 0) {  // busy: the picture that came too late last time is still on its way
    CAMERA_CONTROL = CONTROL_TAKE;
    if ((CAMERA_STATUS & STATUS_REFUSED) != 0) {
      CAMERA_STATUS = STATUS_REFUSED;
      return PICTURE_REFUSED;
    }
  }
  timer_set_alarm(deadline_ns);
  while (outcome == 0 && !timer_alarm_came()) {
    sleep_until_interrupt();
  }
  if (outcome == 0) {
    return PICTURE_LATE;
  }
  if ((outcome & STATUS_READY) == 0) {
    return PICTURE_REFUSED;
  }
  picture->pixels = buffer;
  picture->width = (int)CAMERA_WIDTH;
  picture->height = (int)CAMERA_HEIGHT;
  picture->id = CAMERA_FRAME_ID;
  return PICTURE_TAKEN;
}
