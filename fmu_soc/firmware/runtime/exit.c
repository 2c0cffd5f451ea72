// SPDX-License-Identifier: Apache-2.0
#include "runtime/exit.h"

#include "runtime/character.h"
#include "runtime/core.h"
#include "runtime/interrupt.h"

void firmware_exit(int code) {
  flush_characters();
  sleep_clock_lower();
  core_end(code);
  for (;;) {
    __asm__ volatile("wfi");
  }
}
