// SPDX-License-Identifier: Apache-2.0
// Drives GAP8's timer. Its two 32-bit counters form one counter of the reference clock, with a period of 30.5 us.
#include "drivers/timer.h"

#include "runtime/interrupt.h"
#include "runtime/registers.h"

// A count is NS / 2^COUNTS_LOG2 nanoseconds: 1e9 / 32768.
#define NS 1953125
#define COUNTS_LOG2 6

static volatile bool alarm_came;
static uint64_t alarm_count;

static uint64_t count(void) {
  for (;;) {
    const uint32_t high = load(TIMER_BASE + TIMER_COUNT_HI_OFFSET);
    const uint32_t low = load(TIMER_BASE + TIMER_COUNT_LO_OFFSET);
    if (load(TIMER_BASE + TIMER_COUNT_HI_OFFSET) == high) {
      return (uint64_t)high << 32 | low;
    }
  }
}

// Sets alarm_came if the time of the alarm has passed. An event of the timer may be from an earlier alarm that has been
// replaced, and then has no effect.
static void check_alarm(void) {
  if (count() >= alarm_count) {
    alarm_came = true;
  }
}

void timer_init(void) {
  interrupt_attach(FABRIC_EVENT_TIMER, check_alarm);
}

int64_t timer_now_ns(void) {
  return (int64_t)(count() * NS >> COUNTS_LOG2);
}

void timer_set_alarm(int64_t time_ns) {
  // Two parts, because the product of time and 2^COUNTS_LOG2 may exceed 64 bits.
  const uint64_t groups = time_ns <= 0 ? 0 : (uint64_t)time_ns / NS;
  const uint32_t rest_ns = time_ns <= 0 ? 0 : (uint32_t)((uint64_t)time_ns - groups * NS);
  alarm_count = (groups << COUNTS_LOG2) + ((rest_ns << COUNTS_LOG2) + NS - 1) / NS;
  alarm_came = false;
  store(TIMER_BASE + TIMER_COMPARE_LO_OFFSET, (uint32_t)alarm_count);
  store(TIMER_BASE + TIMER_COMPARE_HI_OFFSET, (uint32_t)(alarm_count >> 32));
  check_alarm();  // the timer raises an event only if count and alarm are equal
}

#include "drivers/timer_alarm.inc"
