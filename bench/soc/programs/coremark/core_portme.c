// SPDX-License-Identifier: Apache-2.0
#include "coremark.h"

volatile ee_s32 seed1_volatile = 0;
volatile ee_s32 seed2_volatile = 0;
volatile ee_s32 seed3_volatile = 0x66;
volatile ee_s32 seed4_volatile = ITERATIONS;
volatile ee_s32 seed5_volatile = 0;
ee_u32 default_num_contexts = 1;
int coremark_failed = 1;

void start_time(void) {}
void stop_time(void) {}
// Returns a constant that satisfies CoreMark's minimum of ten seconds. Only the simulator's processor time is measured.
CORE_TICKS get_time(void) {
  return 20;
}
secs_ret time_in_secs(CORE_TICKS ticks) {
  return ticks;
}

void portable_init(core_portable* p, int* argc, char* argv[]) {
  (void)argc;
  (void)argv;
  p->portable_id = 1;
}
void portable_fini(core_portable* p) {
  p->portable_id = 0;
}

// Clears coremark_failed if the text is CoreMark's message about correct checksums.
int ee_printf(const char* format, ...) {
  static const char right[] = "Correct operation validated";
  for (unsigned i = 0; i < sizeof right - 1; ++i) {
    if (format[i] != right[i]) return 0;
  }
  coremark_failed = 0;
  return 0;
}
