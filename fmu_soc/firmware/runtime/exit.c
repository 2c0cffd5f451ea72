// SPDX-License-Identifier: Apache-2.0
#include "runtime/exit.h"

#include "board.h"
#include "runtime/interrupt.h"

void firmware_exit(int code) {
  sleep_clock_lower();
  POWER_MANAGER_EXIT = (uint32_t)code;
  for (;;) {
    __asm__ volatile("wfi");
  }
}
