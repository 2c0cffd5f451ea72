// SPDX-License-Identifier: Apache-2.0
// Drives the nanosecond timer.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define NS_PER_US INT64_C(1000)
#define NS_PER_MS INT64_C(1000000)

// Attaches the timer's interrupt. Must be called once, with interrupts off.
void timer_init(void);

// Returns the time since reset [ns].
int64_t timer_now_ns(void);

// Sets the alarm to `time_ns`. If that time has passed, the interrupt is raised at once.
void timer_set_alarm(int64_t time_ns);

// Returns true if the time of the last alarm has passed.
bool timer_alarm_came(void);

void timer_sleep_until(int64_t time_ns);

#ifdef __cplusplus
}
#endif
