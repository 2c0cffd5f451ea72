// SPDX-License-Identifier: Apache-2.0
// Tests the timer of GAP8's cluster: its counters, and programs that wait for its events.
#include "devices/gap8/timer.hpp"
#include "gap8_system.hpp"
#include "runtime/registers.h"
#include "support/same_state.hpp"

#include "mebots/state/save.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mebots::soc::test {
namespace {

using gap8_devices::ClusterTimer;

class ClusterTimerTest : public testing::Test {
 protected:
  std::uint32_t load(std::uint32_t offset, std::uint64_t tick) {
    std::uint32_t value = 0;
    EXPECT_TRUE(timer.load(offset, tick, value));
    return value;
  }

  std::vector<unsigned> raised;
  ClusterTimer timer{[this](unsigned counter) { raised.push_back(counter); }};
};

TEST_F(ClusterTimerTest, CountsTicksAndRaisesAnEventAtEachMatch) {
  timer.store(TIMER_COMPARE_HI_OFFSET, 100, 30);
  timer.store(TIMER_CONFIG_HI_OFFSET, 100, 0x15);  // high counter: enabled, raises events, restarts
  EXPECT_EQ(load(TIMER_COUNT_HI_OFFSET, 117), 17U);
  EXPECT_EQ(timer.next_tick(), 130U);
  timer.advance(130);
  EXPECT_EQ(raised, std::vector<unsigned>{1});
  EXPECT_EQ(timer.next_tick(), 160U);
  EXPECT_EQ(load(TIMER_COUNT_HI_OFFSET, 135), 5U);
  EXPECT_EQ(load(TIMER_COUNT_LO_OFFSET, 135), 0U) << "the low one is off";
}

TEST_F(ClusterTimerTest, StopsAfterOneShotAndCountsInPairsAndByItsPrescaler) {
  timer.store(TIMER_COMPARE_LO_OFFSET, 0, 4);
  timer.store(TIMER_CONFIG_LO_OFFSET, 0, 0x65 | 2U << 8);  // one shot; counts every third tick
  EXPECT_EQ(timer.next_tick(), 12U);
  timer.advance(12);
  EXPECT_EQ(timer.next_tick(), kNoTick);
  EXPECT_EQ(load(TIMER_COUNT_LO_OFFSET, 1000), 4U);
  timer.store(TIMER_CONFIG_LO_OFFSET, 1000, 1U << 31);
  timer.store(TIMER_COUNT_LO_OFFSET, 1000, 0xffffffffU);
  timer.store(0x18, 1000, 1);
  EXPECT_EQ(load(TIMER_COUNT_HI_OFFSET, 1002), 1U) << "carried over";
  EXPECT_EQ(load(TIMER_COUNT_LO_OFFSET, 1002), 1U);
}

TEST_F(ClusterTimerTest, ComparesBothHalvesOfAPairAfterEachStore) {
  timer.store(TIMER_COMPARE_LO_OFFSET, 0, 10);
  timer.store(TIMER_COMPARE_HI_OFFSET, 0, 1);
  timer.store(TIMER_CONFIG_LO_OFFSET, 0, 1U << 31 | 0x05);
  timer.store(TIMER_COMPARE_HI_OFFSET, 10, 0);
  EXPECT_EQ(raised, (std::vector<unsigned>{0})) << "the comparison came to the count";
  timer.store(TIMER_COMPARE_HI_OFFSET, 10, 1);
  timer.store(TIMER_COUNT_HI_OFFSET, 10, 1);
  EXPECT_EQ(raised, (std::vector<unsigned>{0, 0})) << "the count came to the comparison";
}

TEST_F(ClusterTimerTest, RestartsACountWhenEitherHalfOfAPairIsStored) {
  for (const std::uint32_t half : {TIMER_COUNT_LO_OFFSET, TIMER_COUNT_HI_OFFSET}) {
    timer.reset();
    timer.store(TIMER_CONFIG_LO_OFFSET, 0, 1U << 31 | 0x41 | 2U << 8);  // counts every third tick
    timer.store(half, 2, 0);
    EXPECT_EQ(load(TIMER_COUNT_LO_OFFSET, 4), 0U) << half;
    EXPECT_EQ(load(TIMER_COUNT_LO_OFFSET, 5), 1U) << half;
  }
}

TEST_F(ClusterTimerTest, KeepsItsCountsWhenAPairIsSplitOrFormed) {
  timer.store(TIMER_CONFIG_LO_OFFSET, 0, 1U << 31 | 1);
  timer.store(TIMER_COUNT_LO_OFFSET, 0, 0xfffffff0U);
  timer.store(TIMER_CONFIG_HI_OFFSET, 0, 1);     // no effect while both counters form one
  timer.store(TIMER_CONFIG_LO_OFFSET, 1000, 1);  // from here on, the counters are separate
  EXPECT_EQ(load(TIMER_COUNT_LO_OFFSET, 1000), 984U);
  EXPECT_EQ(load(TIMER_COUNT_HI_OFFSET, 1000), 1U) << "carried over, and nothing for the time in the pair";
  EXPECT_EQ(load(TIMER_COUNT_HI_OFFSET, 1010), 11U);
  timer.store(TIMER_CONFIG_LO_OFFSET, 1010, 1U << 31);
  EXPECT_EQ(load(TIMER_COUNT_LO_OFFSET, 1020), 994U) << "off";
  EXPECT_EQ(load(TIMER_COUNT_HI_OFFSET, 1020), 11U);
}

TEST_F(ClusterTimerTest, RaisesNoMaskedEventAndStopsAtTheReferenceClock) {
  timer.store(TIMER_CONFIG_LO_OFFSET, 0, 1);
  EXPECT_EQ(timer.next_tick(), kNoTick) << "it counts only";
  timer.store(TIMER_CONFIG_LO_OFFSET, 10, 0x85);
  EXPECT_TRUE(ClusterTimer::wants_reference_clock(TIMER_CONFIG_LO_OFFSET, 0x85));
  EXPECT_EQ(timer.next_tick(), kNoTick);
  EXPECT_EQ(load(TIMER_COUNT_LO_OFFSET, 500), 10U);
}

/// Core 0 sets the cluster's timer to 1000 ticks. Its event wakes cores 0 and 1, and interrupts core 2. Each of these
/// cores then stores the timer's count.
constexpr std::string_view kTimed = R"(
2:  wfi
    j 2b
core: li s0, EU_BASE
    li s1, TIMER_BASE      # the timer
    li s3, RESULTS
    csrr a0, mhartid
    slli a1, a0, 2
    add s3, s3, a1
    li a1, 1 << 10
    li a2, 2
    beq a0, a2, 4f
    sw a1, EU_MASK_OR_OFFSET(s0)
    bnez a0, 3f
    li a1, 1000
    sw a1, TIMER_COMPARE_LO_OFFSET(s1)
    li a1, 0x07            # from 0, with its event
    sw a1, TIMER_CONFIG_LO_OFFSET(s1)
3:  .insn i 0x03, 6, a4, EU_WAIT_CLEAR_OFFSET(s0)
    lw a5, TIMER_COUNT_LO_OFFSET(s1)
    sw a5, 0(s3)
    sw a4, 0x20(s3)
5:  .insn i 0x03, 6, a4, EU_WAIT_CLEAR_OFFSET(s0)
    j 5b
4:  sw a1, EU_MASK_IRQ_OR_OFFSET(s0)
    csrsi mstatus, 8
6:  j 6b                   # awake, so that only the interrupt ends it
fault: csrr a0, mcause
    lw a5, TIMER_COUNT_LO_OFFSET(s1)
    sw a5, 0(s3)
    sw a0, 0x20(s3)
    j 5b
)";

TEST(Gap8Cluster, WakesAndInterruptsItsCoresByTheClustersTimer) {
  auto system = timed_system(0b111, kTimed);
  system.soc.advance(5 * kMs);
  EXPECT_TRUE(system.faults.empty()) << system.faults.front();
  EXPECT_EQ(system.result(8), 1U << 10);
  EXPECT_EQ(system.result(9), 1U << 10);
  EXPECT_EQ(system.result(10), 0x80000000U | 10U);
  for (unsigned core = 0; core < 3; ++core) {
    EXPECT_GE(system.result(core), 1000U) << core;
    EXPECT_LE(system.result(core), 1016U) << core;
  }
}

/// Only one core is awake. It sets the timer to 100 ticks and waits in a loop. Its handler stores the timer's count.
constexpr std::string_view kTimedAlone = R"(
2:  wfi
    j 2b
core: li s0, EU_BASE
    li s1, TIMER_BASE      # the timer
    li s3, RESULTS
    li a1, 1 << 10
    sw a1, EU_MASK_IRQ_OR_OFFSET(s0)
    csrsi mstatus, 8
    li a1, 100
    sw a1, TIMER_COMPARE_LO_OFFSET(s1)
    li a1, 0x07            # from 0, with its event
    sw a1, TIMER_CONFIG_LO_OFFSET(s1)
3:  j 3b
fault: csrr a0, mcause
    lw a5, TIMER_COUNT_LO_OFFSET(s1)
    sw a5, 0(s3)
    sw a0, 4(s3)
4:  .insn i 0x03, 6, a4, EU_WAIT_CLEAR_OFFSET(s0)
    j 4b
)";

TEST(Gap8Cluster, InterruptsInTimeTheOnlyAwakeCore) {
  auto system = timed_system(1, kTimedAlone);
  system.soc.advance(5 * kMs);
  EXPECT_TRUE(system.faults.empty()) << system.faults.front();
  EXPECT_EQ(system.result(1), 0x80000000U | 10U);
  EXPECT_GE(system.result(0), 100U);
  EXPECT_LE(system.result(0), 116U);
}

TEST(Gap8Cluster, KeepsTheTimersEventInAState) {
  const auto program = fmt::format("{}{}{}", kBegin, start_cluster(0b11), kTimed);
  Gap8System straight(program);
  straight.soc.advance(1 * kMs);
  EXPECT_EQ(straight.result(8), 1U << 10);
  Gap8System first(program);
  Gap8System second(program);
  first.soc.advance(25'000);  // all cores wait
  ASSERT_EQ(first.result(8), 0U);
  ASSERT_TRUE(first.soc.hart(1).sleeping());
  state::restore(second.soc, state::save(first.soc));
  second.soc.advance(1 * kMs);
  EXPECT_TRUE(mebots::test::same_state(second.soc, straight.soc));
}

TEST(Gap8Cluster, LetsTheFabricControllerReadTheClustersTimer) {
  Gap8System system(R"(
_start: li s0, SOC_CONTROL_BASE
    li a0, BYPASS_CLUSTER_ON
    sw a0, SOC_CONTROL_CL_BYPASS_OFFSET(s0)
    li s0, CLUSTER_BASE
    li a0, 3
    sw a0, 0x400(s0)
    lw a1, 0x408(s0)
    lw a2, 0x408(s0)
    li s1, RESULTS
    sw a1, 0(s1)
    sw a2, 4(s1)
    li a0, 0x83
    sw a0, 0x400(s0)
2:  j 2b
)");
  system.soc.advance(1 * kMs);
  EXPECT_GT(system.result(1), system.result(0));
  ASSERT_EQ(system.faults.size(), 1U);
  EXPECT_THAT(system.faults[0], testing::HasSubstr("reference clock is not modelled"));
}

}  // namespace
}  // namespace mebots::soc::test
