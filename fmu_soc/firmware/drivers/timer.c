// SPDX-License-Identifier: Apache-2.0
#include "drivers/timer.h"

#include "board.h"
#include "runtime/interrupt.h"

static volatile bool alarm_came;

static void set_compare(uint64_t time_ns) {
  // The first store prevents a match with an intermediate value.
  TIMER_COMPARE_HI = UINT32_MAX;
  TIMER_COMPARE_LO = (uint32_t)time_ns;
  TIMER_COMPARE_HI = (uint32_t)(time_ns >> 32);
}

static void on_timer(void) {
  set_compare(UINT64_MAX);
  alarm_came = true;
}

void timer_init(void) {
  set_compare(UINT64_MAX);
  interrupt_attach(TIMER_INTERRUPT, on_timer);
}

int64_t timer_now_ns(void) {
  const uint32_t low = TIMER_TIME_LO;  // latches the high word
  const uint32_t high = TIMER_TIME_HI;
  return (int64_t)(((uint64_t)high << 32) | low);
}

void timer_set_alarm(int64_t time_ns) {
  alarm_came = false;
  set_compare((uint64_t)time_ns);
}

#include "drivers/timer_alarm.inc"
