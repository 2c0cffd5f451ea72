// SPDX-License-Identifier: Apache-2.0
#include "runtime/exit.h"

#include "board.h"

void firmware_exit(int code) {
  POWER_MANAGER_EXIT = (uint32_t)code;
  for (;;) {
    __asm__ volatile("wfi");
  }
}
