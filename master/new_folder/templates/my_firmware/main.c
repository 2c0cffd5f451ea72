// SPDX-License-Identifier: Apache-2.0
// Prints the time several times and sleeps in between. Ends with exit code 0.
#include "drivers/timer.h"
#include "runtime/console.h"

#define NAPS 5

int main(void) {
  timer_init();
  for (uint32_t nap = 1; nap <= NAPS; ++nap) {
    timer_sleep_until(nap * 10 * NS_PER_MS);
    print("awake at %u us\n", (uint32_t)(timer_now_ns() / NS_PER_US));
  }
  return 0;
}
