// SPDX-License-Identifier: Apache-2.0
// Controls the cluster through GAP8's registers. A fork raises a software event for the cores that take part (the
// team), which read their job from L1. At the end, core 0 waits for the team at a second barrier, and raises an event
// of the fabric controller.
#include "runtime/cluster.h"

#include <stdbool.h>

#include "runtime/chip.h"
#include "runtime/core.h"
#include "runtime/soc_events.h"

#define INFO_CORES_SHIFT 16
#define JOB_DONE (UINT32_C(1) << FABRIC_EVENT_JOB_DONE)
#define BARRIER_OF(number) (EU_OF_CLUSTER_BASE + EU_LONG_BARRIER_OFFSET + (number)*BARRIER_BYTES)

// Interrupt vectors of the cluster's cores. The first instruction of the cores is directly after the vectors.
extern const char cluster_vectors[];

struct {
  cluster_entry_t entry;
  void* argument;
} cluster_job CLUSTER_L1;

static volatile unsigned power_changed;
static volatile unsigned clock_changed;
static uint32_t clock_hz;  // 0 = initial clock
static uint32_t team;
static bool works;

static void on_power(void) {
  power_changed = 1;
}

static void on_clock(void) {
  clock_changed = 1;
}

// Stores `bypass` into CL_BYPASS, and sleeps until the change is complete.
static void switch_power(uint32_t bypass) {
  power_changed = 0;
  SOC_CONTROL_CL_BYPASS = bypass;
  soc_event_wait(&power_changed);
}

static void switch_clock(uint32_t bypass) {
  clock_changed = 0;
  SOC_CONTROL_CL_BYPASS = bypass;
  soc_event_wait(&clock_changed);
}

static bool is_on(void) {
  return (SOC_CONTROL_CL_BYPASS & BYPASS_CLUSTER_ON) != 0;
}

// Order as in gap_sdk (kernel/gap/maestro.c): power, isolation, reset, clock.
int cluster_on(void) {
  const unsigned cores = cluster_core_count();
  if (cores == 0) {
    return -1;
  }
  // If the cluster is already on, the chip raises no event.
  if (is_on()) {
    return 0;
  }
  soc_event_attach(SOC_EVENT_CLUSTER_POWER, on_power);
  soc_event_attach(SOC_EVENT_CLUSTER_CLOCK, on_clock);
  uint32_t bypass = SOC_CONTROL_CL_BYPASS | BYPASS_POWER_UNIT | BYPASS_CLOCK;
  if ((bypass & BYPASS_CLOCK_GATE) == 0) {
    bypass |= BYPASS_CLOCK_GATE;
    switch_clock(bypass);
  }
  bypass |= BYPASS_CLUSTER_ON;
  switch_power(bypass);
  SOC_CONTROL_CL_ISOLATE = 0;
  bypass &= ~(uint32_t)BYPASS_CLUSTER_RESET;
  SOC_CONTROL_CL_BYPASS = bypass;
  switch_clock(bypass & ~(uint32_t)BYPASS_CLOCK_GATE);
  loop_set(LOOP_CLUSTER, clock_hz != 0 ? clock_hz : START_CLUSTER_CLOCK_HZ);
  for (unsigned core = 0; core < cores; ++core) {
    store(CLUSTER_BASE + CLUSTER_BOOT_OFFSET + 4 * core, (uint32_t)(uintptr_t)cluster_vectors);
  }
  store(CLUSTER_BASE + CLUSTER_CACHE_ENABLE_OFFSET, UINT32_MAX);
  store(CLUSTER_BASE + CLUSTER_FETCH_ENABLE_OFFSET, (UINT32_C(1) << cores) - 1);
  team = 0;
  return 0;
}

void cluster_off(void) {
  if (!is_on()) {
    return;
  }
  uint32_t bypass = SOC_CONTROL_CL_BYPASS | BYPASS_CLOCK_GATE;
  switch_clock(bypass);
  SOC_CONTROL_CL_ISOLATE = 1;
  bypass &= ~(uint32_t)BYPASS_CLUSTER_ON;
  switch_power(bypass);
  SOC_CONTROL_CL_BYPASS = bypass | BYPASS_CLUSTER_RESET;
  works = false;
}

int cluster_clock_set(uint32_t hz) {
  if (loop_set(LOOP_CLUSTER, hz) != 0) {
    return -1;
  }
  clock_hz = hz;
  return 0;
}

unsigned cluster_core_count(void) {
  return SOC_CONTROL_INFO >> INFO_CORES_SHIFT;
}

int cluster_fork(cluster_entry_t entry, unsigned cores, void* argument) {
  if (works && (load(EU_BASE + EU_BUFFER_OFFSET) & JOB_DONE) == 0) {
    return -1;
  }
  if (cores == 0 || cores > cluster_core_count()) {
    return -1;
  }
  const uint32_t wanted = (UINT32_C(1) << cores) - 1;
  if (wanted != team) {
    team = wanted;
    store(BARRIER_OF(0) + BARRIER_TEAM_OFFSET, team);
    store(BARRIER_OF(0) + BARRIER_TARGETS_OFFSET, team);
    store(BARRIER_OF(1) + BARRIER_TEAM_OFFSET, team);
    store(BARRIER_OF(1) + BARRIER_TARGETS_OFFSET, 1);
  }
  store(EU_BASE + EU_BUFFER_CLEAR_OFFSET, JOB_DONE);
  cluster_job.entry = entry;
  cluster_job.argument = argument;
  __asm__ volatile("" ::: "memory");
  store(EU_OF_CLUSTER_BASE + EU_SOFTWARE_EVENT_OFFSET + 4 * CLUSTER_EVENT_JOB, team);
  works = true;
  return 0;
}

void cluster_wait(void) {
  if (works) {
    core_sleep_until(FABRIC_EVENT_JOB_DONE);
    works = false;
  }
}
