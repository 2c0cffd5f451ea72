// SPDX-License-Identifier: Apache-2.0
#include "drivers/camera.h"

#include "board.h"
#include "drivers/timer.h"
#include "runtime/interrupt.h"

#define CONTROL_TAKE 1U
#define STATUS_READY 2U
#define STATUS_REFUSED 4U

// Size of the sensor's largest picture.
#define BUFFER_BYTES (324 * 324)

static uint8_t buffers[2][BUFFER_BYTES] __attribute__((aligned(4), section(".noinit.camera")));
// Index of the buffer for the requested picture. Without a request, index of the buffer with the last picture.
static unsigned filling;
static bool is_requested;
// Status bits READY and REFUSED of interrupts since the last request.
static volatile uint32_t outcome;

// Handles the interrupt: a picture has arrived, or was dropped because it does not fit into the buffer.
static void on_camera(void) {
  const uint32_t status = CAMERA_STATUS & (STATUS_READY | STATUS_REFUSED);
  CAMERA_STATUS = status;  // clears the interrupt
  outcome |= status;
}

void camera_init(void) {
  CAMERA_BUFFER_SIZE = BUFFER_BYTES;
  interrupt_attach(CAMERA_INTERRUPT, on_camera);
}

bool camera_ask(void) {
  if (is_requested) {
    return true;
  }
  outcome = 0;
  filling ^= 1;
  CAMERA_BUFFER = (uint32_t)(uintptr_t)buffers[filling];
  CAMERA_CONTROL = CONTROL_TAKE;
  if ((CAMERA_STATUS & STATUS_REFUSED) != 0) {
    CAMERA_STATUS = STATUS_REFUSED;
    return false;
  }
  is_requested = true;
  return true;
}

camera_result_t camera_wait(picture_t* picture, int64_t deadline_ns) {
  timer_set_alarm(deadline_ns);
  while (outcome == 0 && !timer_alarm_came()) {
    sleep_until_interrupt();
  }
  if (outcome == 0) {
    return PICTURE_LATE;
  }
  is_requested = false;
  if ((outcome & STATUS_READY) == 0) {
    return PICTURE_REFUSED;
  }
  picture->pixels = buffers[filling];
  picture->width = (int)CAMERA_WIDTH;
  picture->height = (int)CAMERA_HEIGHT;
  picture->id = CAMERA_FRAME_ID;
  return PICTURE_TAKEN;
}
