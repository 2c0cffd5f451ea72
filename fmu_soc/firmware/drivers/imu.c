// SPDX-License-Identifier: Apache-2.0
#include "drivers/imu.h"

#include "board.h"
#include "runtime/interrupt.h"

// 32768 counts are 24 g for the accelerometer and 2000 degrees/s for the gyroscope.
#define M_S2_PER_COUNT (24.0F * 9.80665F / 32768.0F)
#define RAD_S_PER_COUNT (2000.0F * 3.14159265F / 180.0F / 32768.0F)
#define LEVEL_MASK 0xFFU

// The interrupt is active while the FIFO contains a sample. It only ends the sleep in imu_wait(), which enables the
// interrupt again.
static void on_imu(void) {
  IMU_THRESHOLD = 0;
}

void imu_init(uint32_t period_us) {
  IMU_PERIOD = period_us;
  IMU_THRESHOLD = 0;
  interrupt_attach(IMU_INTERRUPT, on_imu);
  IMU_CONTROL = 1;
}

static float force(uint32_t counts) {
  return M_S2_PER_COUNT * (float)(int32_t)counts;
}
static float rate(uint32_t counts) {
  return RAD_S_PER_COUNT * (float)(int32_t)counts;
}

unsigned imu_wait(imu_sample_t* sample) {
  unsigned level = IMU_STATUS & LEVEL_MASK;
  while (level == 0) {
    IMU_THRESHOLD = 1;
    sleep_until_interrupt();
    level = IMU_STATUS & LEVEL_MASK;
  }
  sample->time_us = IMU_TIME;
  sample->acceleration =
      (flight_vector_t){force(IMU_ACCELERATION_X), force(IMU_ACCELERATION_Y), force(IMU_ACCELERATION_Z)};
  sample->rate = (flight_vector_t){rate(IMU_RATE_X), rate(IMU_RATE_Y), rate(IMU_RATE_Z)};
  IMU_NEXT = 1;
  return level - 1;
}
