// SPDX-License-Identifier: Apache-2.0
// Tests the registers of the event unit of GAP8's cluster against archi/eu/eu_v3.h, and a barrier of eight cores.
#include "devices/gap8/cluster_event_unit.hpp"
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

using gap8_devices::ClusterEventUnit;

constexpr std::uint32_t kMaskOr = EU_MASK_OR_OFFSET;
constexpr std::uint32_t kMaskIrqOr = EU_MASK_IRQ_OR_OFFSET;
constexpr std::uint32_t kBuffer = EU_BUFFER_OFFSET;
constexpr std::uint32_t kWaitClear = EU_WAIT_CLEAR_OFFSET;
constexpr std::uint32_t kDispatch = 0x80;
constexpr std::uint32_t kTeam = 0x84;
constexpr std::uint32_t kMutex = 0xC0;
constexpr std::uint32_t kTrigger = 0x100;
constexpr std::uint32_t kBarrier = EU_BARRIER_OFFSET;

/// An event unit for four cores. The functions access the address range in which each core has its own registers
/// (EU_*_DEMUX_OFFSET).
class EventUnitOfFour : public testing::Test {
 protected:
  BusReply store(unsigned core, std::uint32_t offset, std::uint32_t value) {
    return unit.own(core, offset, &value, false);
  }
  std::uint32_t load(unsigned core, std::uint32_t offset) { return unit.own(core, offset, nullptr, false).value; }
  BusReply wait(unsigned core, std::uint32_t offset) { return unit.own(core, offset, nullptr, true); }
  bool blocks(unsigned core, std::uint32_t offset) { return wait(core, offset).kind == BusReply::Kind::blocked; }

  ClusterEventUnit unit{4};
};

TEST_F(EventUnitOfFour, WakesTheTargetsOfASoftwareEventThatUnmaskIt) {
  store(1, kMaskOr, 1U << 3);
  EXPECT_TRUE(blocks(1, kWaitClear));
  EXPECT_TRUE(blocks(2, kWaitClear));
  store(0, kTrigger + 4 * 3, 0b0110);
  EXPECT_EQ(unit.take_woken(), 0b0010U) << "core 2 lets nothing through";
  EXPECT_EQ(wait(1, kWaitClear).value, 1U << 3);
  EXPECT_EQ(load(1, kBuffer), 0U);
  EXPECT_EQ(load(2, kBuffer), 1U << 3);
  store(0, kTrigger, 0);
  for (unsigned core = 0; core < 4; ++core) EXPECT_EQ(load(core, kBuffer) & 1U, 1U) << "0 names all, " << core;
}

TEST_F(EventUnitOfFour, OpensTheBarrierWhenTheLastCoreOfItsTeamArrives) {
  store(0, kBarrier, 0b0111);
  store(0, kBarrier + BARRIER_TARGETS_OFFSET, 0b0111);
  for (unsigned core = 0; core < 4; ++core) store(core, kMaskOr, 1U << 16);
  EXPECT_TRUE(blocks(0, kBarrier + BARRIER_ARRIVE_WAIT_OFFSET));
  EXPECT_TRUE(blocks(0, kBarrier + BARRIER_ARRIVE_WAIT_OFFSET)) << "asking again is not coming again";
  EXPECT_TRUE(blocks(2, kBarrier + BARRIER_ARRIVE_WAIT_OFFSET));
  EXPECT_EQ(load(3, kBarrier + 0x04), 0b0101U);
  EXPECT_EQ(unit.take_woken(), 0U);
  EXPECT_EQ(wait(1, kBarrier + BARRIER_ARRIVE_WAIT_OFFSET).kind, BusReply::Kind::done);
  EXPECT_EQ(unit.take_woken() & 0b0101U, 0b0101U);
  EXPECT_EQ(wait(0, kBarrier + BARRIER_ARRIVE_WAIT_OFFSET).value, 1U << 16);
  EXPECT_EQ(wait(2, kBarrier + BARRIER_ARRIVE_WAIT_OFFSET).value, 1U << 16);
  EXPECT_EQ(load(0, kBarrier + 0x04), 0U);
  EXPECT_TRUE(blocks(1, kBarrier + BARRIER_ARRIVE_WAIT_OFFSET)) << "the next round";
}

TEST_F(EventUnitOfFour, GivesTheMutexToTheWaitingCoreWithTheLowestNumber) {
  for (unsigned core = 0; core < 4; ++core) store(core, kMaskOr, 1U << 17);
  EXPECT_EQ(wait(2, kMutex).kind, BusReply::Kind::done);
  EXPECT_TRUE(blocks(3, kMutex));
  EXPECT_TRUE(blocks(1, kMutex));
  store(2, kMutex, 77);
  EXPECT_EQ(unit.take_woken(), 0b0010U);
  EXPECT_TRUE(blocks(0, kMutex)) << "it has an owner";
  EXPECT_EQ(wait(1, kMutex).value, 77U);
  store(1, kMutex, 0);
  EXPECT_EQ(unit.take_woken() & 0b0001U, 1U);
  wait(0, kMutex);
  store(0, kMutex, 0);
  wait(3, kMutex);
  store(3, kMutex, 5);
  EXPECT_EQ(wait(0, kMutex).value, 5U) << "free, with the last message";
}

TEST_F(EventUnitOfFour, DispatchesWordsToTheTeamInTheirOrder) {
  store(1, kMaskOr, 1U << 18);
  store(2, kMaskOr, 1U << 18);
  EXPECT_TRUE(blocks(1, kDispatch));
  store(0, kTeam, 0b0010);
  store(0, kDispatch, 0x1C001000);
  EXPECT_EQ(unit.take_woken(), 0b0010U);
  store(0, kDispatch, 42);
  EXPECT_EQ(wait(1, kDispatch).value, 0x1C001000U);
  EXPECT_EQ(wait(1, kDispatch).value, 42U);
  EXPECT_TRUE(blocks(1, kDispatch));
  EXPECT_TRUE(blocks(2, kDispatch)) << "not of the team";
}

TEST_F(EventUnitOfFour, PresentsTheHighestInterruptAndClearsItWhenTaken) {
  store(3, kMaskIrqOr, 0b1010);
  store(0, kTrigger + 4 * 1, 0b1000);
  store(0, kTrigger + 4 * 3, 0b1000);
  EXPECT_EQ(unit.lines(3), 1U << 3);
  unit.interrupt_taken(3, 3);
  EXPECT_EQ(unit.lines(3), 1U << 1);
  EXPECT_EQ(unit.lines(0), 0U);
}

TEST_F(EventUnitOfFour, ShowsAllCoresRegistersOnThePeripheralBus) {
  const std::uint32_t mask = 0x30;
  EXPECT_EQ(unit.shared(2 * 0x40, &mask).kind, BusReply::Kind::done);
  EXPECT_EQ(load(2, 0), 0x30U);
  EXPECT_EQ(unit.shared(2 * 0x40, nullptr).value, 0x30U);
  const std::uint32_t all = 0;
  unit.shared(EU_SOFTWARE_EVENT_OFFSET + 4 * 5, &all);
  EXPECT_EQ(load(0, kBuffer), 1U << 5);
  EXPECT_EQ(unit.shared(4 * 0x40, nullptr).kind, BusReply::Kind::none) << "there is no fifth core";
}

/// Returns a program that switches the cluster on, starts eight cores, and waits for core 0's result. Each core copies
/// 64 bytes of L2 into L1, adds them, and waits for the others. Core 0 adds all results and sends the sum.
std::string eight_cores() {
  return fmt::format("{}{}", kBegin, R"(
    li s1, RESULTS
    li s0, SOC_CONTROL_BASE
    li s2, EU_BASE
    li s3, SOC_EVENTS_BASE
    li a0, 0x7fffffff
    sw a0, SOC_EVENT_MASKS_OFFSET + 4(s3)  # hears event 31 of the SoC
    li a0, 0x08000002
    sw a0, EU_MASK_OR_OFFSET(s2)        # events 1 and 27 end a wait
    li a0, BYPASS_CLUSTER_ON
    sw a0, SOC_CONTROL_CL_BYPASS_OFFSET(s0)        # the cluster's power
    .insn i 0x03, 6, a1, EU_WAIT_CLEAR_OFFSET(s2)
    sw a1, 0(s1)
    li a3, EVENT_UNIT_BASE
    lw a3, EU_SOC_EVENT_OFFSET(a3)
    sw a3, 4(s1)
    li a4, 0x08000000
    sw a4, EU_BUFFER_CLEAR_OFFSET(s2)        # the queue is empty
    li s0, CLUSTER_BASE
    la a1, vectors
    li a2, 8
    addi a3, s0, CLUSTER_BOOT_OFFSET
1:  sw a1, 0(a3)
    addi a3, a3, 4
    addi a2, a2, -1
    bnez a2, 1b
    li a0, 0xff
    sw a0, CLUSTER_FETCH_ENABLE_OFFSET(s0)
    .insn i 0x03, 6, a1, EU_WAIT_CLEAR_OFFSET(s2)
    sw a1, 8(s1)
2:  .insn i 0x03, 6, a1, EU_WAIT_CLEAR_OFFSET(s2)
    j 2b

core: li s0, EU_BASE
    li s1, L1_BASE
    li a1, 0x10100
    sw a1, EU_MASK_OR_OFFSET(s0)        # barrier and DMA end a wait
    li a1, 0xff
    sw a1, EU_BARRIER_OFFSET + BARRIER_TEAM_OFFSET(s0)
    sw a1, EU_BARRIER_OFFSET + BARRIER_TARGETS_OFFSET(s0)
    slli s2, a0, 6
    lw a1, DMA_BASE - EU_BASE + DMA_QUEUE_OFFSET(s0)       # a counter of the DMA
    li a2, 64 | 1 << 16 | 1 << 17 | 1 << 19
    sw a2, DMA_BASE - EU_BASE + DMA_QUEUE_OFFSET(s0)
    add a2, s1, s2
    sw a2, DMA_BASE - EU_BASE + DMA_QUEUE_OFFSET(s0)
    la a3, numbers
    add a3, a3, s2
    sw a3, DMA_BASE - EU_BASE + DMA_QUEUE_OFFSET(s0)
    li a4, 1
    sll a4, a4, a1
3:  lw a5, DMA_BASE - EU_BASE + DMA_STATUS_OFFSET(s0)
    and a5, a5, a4
    beqz a5, 4f
    .insn i 0x03, 6, a5, EU_WAIT_CLEAR_OFFSET(s0)
    j 3b
4:  sw a4, DMA_BASE - EU_BASE + DMA_STATUS_OFFSET(s0)
    li a4, 0
    li a5, 16
    mv a6, s2              # by the alias of L1
5:  lw a7, 0(a6)
    add a4, a4, a7
    addi a6, a6, 4
    addi a5, a5, -1
    bnez a5, 5b
    slli a5, a0, 2
    add a5, a5, s1
    sw a4, 0x400(a5)
    .insn i 0x03, 6, a5, EU_BARRIER_OFFSET + BARRIER_ARRIVE_WAIT_OFFSET(s0)
    bnez a0, 7f
    li a4, 0
    li a5, 8
    addi a6, s1, 0x400
6:  lw a7, 0(a6)
    add a4, a4, a7
    addi a6, a6, 4
    addi a5, a5, -1
    bnez a5, 6b
    li a6, RESULTS
    sw a4, 12(a6)
    li a6, EU_OF_FABRIC_CONTROLLER_BASE + EU_SOFTWARE_EVENT_OFFSET + 4
    sw zero, 0(a6)         # event 1 of the fabric controller
7:  sw zero, 0(s0)
8:  .insn i 0x03, 6, a5, EU_WAIT_CLEAR_OFFSET(s0)
    j 8b
fault: j fault
    .balign 4
numbers: .set n, 1
    .rept 128
    .4byte n
    .set n, n + 1
    .endr
)");
}

TEST(Gap8Cluster, RunsEightCoresWithDmaBarrierAndAWordToTheFabricController) {
  Gap8System system(eight_cores());
  system.soc.advance(5 * kMs);
  EXPECT_TRUE(system.faults.empty()) << system.faults.front();
  EXPECT_EQ(system.result(0), 1U << 27);
  EXPECT_EQ(system.result(1), 0x80000000U | 31U) << "the cluster is on";
  EXPECT_EQ(system.result(2), 1U << 1) << "core 0 is done";
  EXPECT_EQ(system.result(3), 128U * 129 / 2);
  EXPECT_TRUE(system.soc.hart().sleeping());
  for (unsigned core = 1; core <= 8; ++core) EXPECT_TRUE(system.soc.hart(core).sleeping()) << core;
}

TEST(Gap8Cluster, GivesTheSameBitsInterpretedAndFromAState) {
  Gap8System straight(eight_cores());
  Settings interpreted;
  interpreted.translate = false;
  Gap8System slow(eight_cores(), interpreted);
  Gap8System first(eight_cores());
  Gap8System second(eight_cores());
  straight.soc.advance(1 * kMs);
  slow.soc.advance(1 * kMs);
  EXPECT_TRUE(mebots::test::same_state(slow.soc, straight.soc));
  first.soc.advance(15'000);  // the cores are running
  state::restore(second.soc, state::save(first.soc));
  second.soc.advance(1 * kMs);
  EXPECT_TRUE(mebots::test::same_state(second.soc, straight.soc));
}

}  // namespace
}  // namespace mebots::soc::test
