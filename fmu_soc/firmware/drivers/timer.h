// SPDX-License-Identifier: Apache-2.0
// Nanosecond timer: the time, and sleep until a time.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define NS_PER_US INT64_C(1000)
#define NS_PER_MS INT64_C(1000000)

// Attaches the timer's interrupt. Call once, with interrupts off.
void timer_init(void);

// Time since reset [ns].
int64_t timer_now_ns(void);

// Arms the timer's interrupt for `time_ns`; a time gone by comes at once.
void timer_set_alarm(int64_t time_ns);

// True once the time of the last alarm has come.
bool timer_alarm_came(void);

// Sleeps until `time_ns`.
void timer_sleep_until(int64_t time_ns);

#ifdef __cplusplus
}
#endif
