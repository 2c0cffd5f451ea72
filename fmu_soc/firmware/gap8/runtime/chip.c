// SPDX-License-Identifier: Apache-2.0
#include "runtime/chip.h"

#include <stdbool.h>

#include "runtime/core.h"
#include "runtime/soc_events.h"
#include "runtime/uart.h"

#define MULTIPLIER_MASK 0xFFFFu
#define DIVIDER_SHIFT 26
#define DIVIDER_MASK 0xFu
// The oscillator of a frequency-locked loop runs near this power of two, as in gap_sdk.
#define OSCILLATOR_LOG2_HZ 29
#define REFERENCE_LOG2_HZ 15

#define VOLTAGE_MASK 0x1Fu
#define VOLTAGE_LOWEST_MV 550
#define VOLTAGE_STEP_MV 50

#define ENDED (UINT32_C(1) << 31)

#define TIMER_RUNS 1u
#define TIMER_FROM_0 2u
#define TIMER_REFERENCE_CLOCK 0x80u
#define TIMER_BOTH (UINT32_C(1) << 31)
#define TIMER_INTERRUPTS 4u

static uint32_t voltage_mv(void) {
  return VOLTAGE_LOWEST_MV + VOLTAGE_STEP_MV * (SOC_CONTROL_SAFE_PMU_RAR & VOLTAGE_MASK);
}

#ifdef MISSION_BASE
// Sets the mission's voltage, which the chip must support.
static void voltage_start(void) {
  const uint32_t others = SOC_CONTROL_SAFE_PMU_RAR & ~VOLTAGE_MASK;
  SOC_CONTROL_SAFE_PMU_RAR = others | (MISSION_SUPPLY_VOLTAGE - VOLTAGE_LOWEST_MV) / VOLTAGE_STEP_MV;
}
#else
// Keeps the voltage that the chip has after reset, because the board has no mission device.
static void voltage_start(void) {}
#endif

static uint32_t config_of(unsigned loop) {
  return FLL_BASE + loop * FLL_BYTES + FLL_CONFIG1_OFFSET;
}

uint32_t loop_hz(unsigned loop) {
  const uint32_t config = load(config_of(loop));
  const uint32_t divider = config >> DIVIDER_SHIFT & DIVIDER_MASK;
  const uint64_t undivided = (uint64_t)(config & MULTIPLIER_MASK) << REFERENCE_LOG2_HZ;
  return (uint32_t)(divider > 1 ? undivided >> (divider - 1) : undivided);
}

// Returns the highest clock at a voltage, interpolated linearly: SoC 150 MHz at 1.0 V and 250 MHz at 1.2 V, cluster 87
// MHz and 175 MHz. Source: FLL_SOC_MIN_FREQUENCY and similar constants in GreenWaves' gap_sdk.
static uint32_t highest_hz(unsigned loop, uint32_t millivolts) {
  const uint32_t above = millivolts > 1000 ? millivolts - 1000 : 0;
  return loop == LOOP_SOC ? 150000000 + above * 500000 : 87000000 + above * 440000;
}

int loop_set(unsigned loop, uint32_t hz) {
  if (hz < REFERENCE_CLOCK_HZ || hz > highest_hz(loop, voltage_mv())) {
    return -1;
  }
  const int log2_hz = 31 - __builtin_clz(hz);
  const int half = (OSCILLATOR_LOG2_HZ - log2_hz) / 2;
  const int halvings = half < 1 ? 1 : half;
  const uint32_t multiplier = (uint32_t)((uint64_t)hz << halvings >> REFERENCE_LOG2_HZ);
  const uint32_t before = load(config_of(loop)) & ~(MULTIPLIER_MASK | DIVIDER_MASK << DIVIDER_SHIFT);
  store(config_of(loop), before | multiplier | (uint32_t)(halvings + 1) << DIVIDER_SHIFT);
  return 0;
}

uint32_t core_clock_hz(void) {
  return loop_hz(LOOP_SOC);
}

void core_clock_set(uint32_t hz) {
  const bool sends = uart_sends() || udma_runs(UDMA_I2C1_SEND_OFFSET);
  if (sends && hz < core_clock_hz()) {
    return;
  }
  loop_set(LOOP_SOC, hz);
}

void core_end(int code) {
  SOC_CONTROL_CORESTATUS = ENDED | (uint32_t)code;
}

void chip_start(void) {
  voltage_start();
  loop_set(LOOP_SOC, START_CLOCK_HZ);
  loop_set(LOOP_CLUSTER, START_CLUSTER_CLOCK_HZ);
  // The timer counts the reference clock, because other clocks may change.
  store(TIMER_BASE + TIMER_COMPARE_LO_OFFSET, UINT32_MAX);
  store(TIMER_BASE + TIMER_COMPARE_HI_OFFSET, UINT32_MAX);
  store(TIMER_BASE + TIMER_CONFIG_LO_OFFSET,
        TIMER_RUNS | TIMER_FROM_0 | TIMER_INTERRUPTS | TIMER_REFERENCE_CLOCK | TIMER_BOTH);
  soc_events_start();
  uart_start();
}
