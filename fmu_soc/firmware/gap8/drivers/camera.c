// SPDX-License-Identifier: Apache-2.0
// Drives an HM01B0 at I2C master 1 and the camera interface of GAP8's uDMA. The interface passes only the middle of the
// sensor's 324 x 324 pixels. On a request, the sensor takes one frame and then enters standby, so that each picture is
// new. A real sensor also needs its manufacturer's values of integration, black level and gain.
#include "drivers/camera.h"

#include "drivers/timer.h"
#include "runtime/chip.h"
#include "runtime/interrupt.h"
#include "runtime/registers.h"
#include "runtime/soc_events.h"

// Edge of the picture that the program uses [px].
#ifndef CAMERA_EDGE
#define CAMERA_EDGE 320
#endif
#define SENSOR_EDGE 324
#define MARGIN ((SENSOR_EDGE - CAMERA_EDGE) / 2)
_Static_assert(MARGIN >= 0 && MARGIN % 2 == 0 && CAMERA_EDGE % 2 == 0, "the interface counts pairs of pixels");

// Bits of the camera interface's registers.
#define INTERFACE_ON (UINT32_C(1) << 31)
#define INTERFACE_WINDOW (UINT32_C(1) << 7)
#define INTERFACE_AS_IT_COMES (UINT32_C(5) << 8)
#define ROW_SHIFT 16

// Addresses and values of the sensor's registers.
#define SENSOR_WRITE 0x48  // I2C address of the sensor, for writes
#define MODE_SELECT 0x0100
#define SOME_FRAMES 3
#define FRAME_COUNT 0x3020

#define I2C_START 0x00
#define I2C_STOP 0x20
#define I2C_BYTE 0x80
#define I2C_DIVIDER 0xE0
#define I2C_HZ 400000

static uint8_t buffers[2][CAMERA_EDGE * CAMERA_EDGE] __attribute__((aligned(4), section(".noinit.camera")));
// Index of the buffer for the requested picture. Without a request, index of the buffer with the last picture.
static unsigned filling;
static bool is_requested;
static uint32_t count;
static volatile bool stored;
static volatile unsigned is_sent;  // true after the last transfer to the sensor
static uint8_t commands[13];
static uint32_t divider;  // from the SoC's clock to the bit rate

static void on_picture(void) {
  stored = true;
}

static void on_sent(void) {
  is_sent = 1;
}

// Stores a value into a register of the sensor. Returns before the end of the transfer, for which the next call waits.
static void write_sensor(uint32_t at, uint32_t value) {
  soc_event_wait(&is_sent);
  is_sent = 0;
  uint8_t* next = commands;
  *next++ = I2C_DIVIDER;
  *next++ = (uint8_t)(divider >> 8);
  *next++ = (uint8_t)divider;
  *next++ = I2C_START;
  const uint32_t bytes[] = {SENSOR_WRITE, at >> 8, at, value};
  for (unsigned i = 0; i < 4; ++i) {
    *next++ = I2C_BYTE;
    *next++ = (uint8_t)bytes[i];
  }
  *next++ = I2C_STOP;
  udma_start(UDMA_I2C1_SEND_OFFSET, commands, (uint32_t)(next - commands));
}

void camera_init(void) {
  divider = START_CLOCK_HZ / (2 * I2C_HZ);
  UDMA_CLOCK_GATE |= UDMA_CLOCK_I2C1 | UDMA_CLOCK_CAMERA;
  soc_event_attach(SOC_EVENT_I2C1_SENT, on_sent);
  soc_event_attach(SOC_EVENT_CAMERA, on_picture);
  is_sent = 1;
  UDMA_CAM_CFG_LL = MARGIN << ROW_SHIFT | MARGIN / 2;
  UDMA_CAM_CFG_UR = (MARGIN + CAMERA_EDGE - 1) << ROW_SHIFT | ((MARGIN + CAMERA_EDGE) / 2 - 1);
  UDMA_CAM_CFG_SIZE = (SENSOR_EDGE - 1) << ROW_SHIFT;
  UDMA_CAM_CFG_GLOB = INTERFACE_ON | INTERFACE_WINDOW | INTERFACE_AS_IT_COMES;
  write_sensor(FRAME_COUNT, 1);
}

bool camera_ask(void) {
  if (is_requested) {
    return true;
  }
  stored = false;
  filling ^= 1;
  // The uDMA transfer must start before the sensor, because the camera interface skips frames that have already
  // started.
  udma_start(UDMA_CAMERA_OFFSET, buffers[filling], sizeof buffers[filling]);
  write_sensor(MODE_SELECT, SOME_FRAMES);
  is_requested = true;
  return true;
}

camera_result_t camera_wait(picture_t* picture, int64_t deadline_ns) {
  timer_set_alarm(deadline_ns);
  while (!stored && !timer_alarm_came()) {
    sleep_until_interrupt();
  }
  if (!stored) {
    return PICTURE_LATE;
  }
  is_requested = false;
  picture->pixels = buffers[filling];
  picture->width = CAMERA_EDGE;
  picture->height = CAMERA_EDGE;
  picture->id = ++count;
  return PICTURE_TAKEN;
}
