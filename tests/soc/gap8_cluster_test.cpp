// SPDX-License-Identifier: Apache-2.0
// GAP8's cluster: its event unit and DMA register by register against the public headers (archi/eu/eu_v3.h,
// archi/dma/mchan_v6.h), and a program that brings eight cores to work on GAP8's own addresses.
#include "board_system.hpp"
#include "devices/gap8/cluster_event_unit.hpp"
#include "devices/gap8/cluster_timer.hpp"
#include "devices/gap8/mchan.hpp"
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
using gap8_devices::ClusterTimer;
using gap8_devices::Mchan;

constexpr std::uint32_t kMaskOr = 0x08;
constexpr std::uint32_t kMaskIrqOr = 0x14;
constexpr std::uint32_t kBuffer = 0x1C;
constexpr std::uint32_t kWaitClear = 0x3C;
constexpr std::uint32_t kDispatch = 0x80;
constexpr std::uint32_t kTeam = 0x84;
constexpr std::uint32_t kMutex = 0xC0;
constexpr std::uint32_t kTrigger = 0x100;
constexpr std::uint32_t kBarrier = 0x200;

/// The event unit of four cores, which ask by the short way.
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

TEST_F(EventUnitOfFour, WakesThoseWhomASoftwareEventNamesAndWhoLetItThrough) {
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

TEST_F(EventUnitOfFour, OpensTheBarrierWhenTheLastOfItsTeamComes) {
  store(0, kBarrier, 0b0111);
  store(0, kBarrier + 0x0C, 0b0111);
  for (unsigned core = 0; core < 4; ++core) store(core, kMaskOr, 1U << 16);
  EXPECT_TRUE(blocks(0, kBarrier + 0x1C));
  EXPECT_TRUE(blocks(0, kBarrier + 0x1C)) << "asking again is not coming again";
  EXPECT_TRUE(blocks(2, kBarrier + 0x1C));
  EXPECT_EQ(load(3, kBarrier + 0x04), 0b0101U);
  EXPECT_EQ(unit.take_woken(), 0U);
  EXPECT_EQ(wait(1, kBarrier + 0x1C).kind, BusReply::Kind::done);
  EXPECT_EQ(unit.take_woken() & 0b0101U, 0b0101U);
  EXPECT_EQ(wait(0, kBarrier + 0x1C).value, 1U << 16);
  EXPECT_EQ(wait(2, kBarrier + 0x1C).value, 1U << 16);
  EXPECT_EQ(load(0, kBarrier + 0x04), 0U);
  EXPECT_TRUE(blocks(1, kBarrier + 0x1C)) << "the next round";
}

TEST_F(EventUnitOfFour, HandsTheMutexToTheLowestWhoWaits) {
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

TEST_F(EventUnitOfFour, PresentsTheHighestInterruptAndForgetsItWhenItIsTaken) {
  store(3, kMaskIrqOr, 0b1010);
  store(0, kTrigger + 4 * 1, 0b1000);
  store(0, kTrigger + 4 * 3, 0b1000);
  EXPECT_EQ(unit.lines(3), 1U << 3);
  unit.interrupt_taken(3, 3);
  EXPECT_EQ(unit.lines(3), 1U << 1);
  EXPECT_EQ(unit.lines(0), 0U);
}

TEST_F(EventUnitOfFour, ShowsAllCoresRegistersByTheLongWay) {
  const std::uint32_t mask = 0x30;
  EXPECT_EQ(unit.shared(2 * 0x40, &mask).kind, BusReply::Kind::done);
  EXPECT_EQ(load(2, 0), 0x30U);
  EXPECT_EQ(unit.shared(2 * 0x40, nullptr).value, 0x30U);
  const std::uint32_t all = 0;
  unit.shared(0x600 + 4 * 5, &all);
  EXPECT_EQ(load(0, kBuffer), 1U << 5);
  EXPECT_EQ(unit.shared(4 * 0x40, nullptr).kind, BusReply::Kind::none) << "there is no fifth core";
}

/// The cluster's timer, with what it raises.
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

TEST_F(ClusterTimerTest, CountsTicksAndRaisesAtItsComparisonAgainAndAgain) {
  timer.store(0x14, 100, 30);
  timer.store(0x04, 100, 0x15);  // the high counter: on, event, begins anew
  EXPECT_EQ(load(0x0C, 117), 17U);
  EXPECT_EQ(timer.next_tick(), 130U);
  timer.advance(130);
  EXPECT_EQ(raised, std::vector<unsigned>{1});
  EXPECT_EQ(timer.next_tick(), 160U);
  EXPECT_EQ(load(0x0C, 135), 5U);
  EXPECT_EQ(load(0x08, 135), 0U) << "the low one is off";
}

TEST_F(ClusterTimerTest, StopsAfterOneShotAndCountsInPairsAndByItsPrescaler) {
  timer.store(0x10, 0, 4);
  timer.store(0x00, 0, 0x65 | 2U << 8);  // one shot, every third tick
  EXPECT_EQ(timer.next_tick(), 12U);
  timer.advance(12);
  EXPECT_EQ(timer.next_tick(), kNoTick);
  EXPECT_EQ(load(0x08, 1000), 4U);
  timer.store(0x00, 1000, 1U << 31);
  timer.store(0x08, 1000, 0xffffffffU);
  timer.store(0x18, 1000, 1);
  EXPECT_EQ(load(0x0C, 1002), 1U) << "carried over";
  EXPECT_EQ(load(0x08, 1002), 1U);
}

TEST_F(ClusterTimerTest, ComparesBothHalvesOfAPairWhicheverIsStored) {
  timer.store(0x10, 0, 10);
  timer.store(0x14, 0, 1);
  timer.store(0x00, 0, 1U << 31 | 0x05);
  timer.store(0x14, 10, 0);
  EXPECT_EQ(raised, (std::vector<unsigned>{0})) << "the comparison came to the count";
  timer.store(0x14, 10, 1);
  timer.store(0x0C, 10, 1);
  EXPECT_EQ(raised, (std::vector<unsigned>{0, 0})) << "the count came to the comparison";
}

TEST_F(ClusterTimerTest, BeginsACountAnewWhereEitherHalfOfAPairIsStored) {
  for (const std::uint32_t half : {0x08U, 0x0CU}) {
    timer.reset();
    timer.store(0x00, 0, 1U << 31 | 0x41 | 2U << 8);  // every third tick
    timer.store(half, 2, 0);
    EXPECT_EQ(load(0x08, 4), 0U) << half;
    EXPECT_EQ(load(0x08, 5), 1U) << half;
  }
}

TEST_F(ClusterTimerTest, KeepsItsCountsWhereAPairIsSplitAndWhereTwoArePaired) {
  timer.store(0x00, 0, 1U << 31 | 1);
  timer.store(0x08, 0, 0xfffffff0U);
  timer.store(0x04, 0, 1);     // means nothing in a pair
  timer.store(0x00, 1000, 1);  // from here on each for itself
  EXPECT_EQ(load(0x08, 1000), 984U);
  EXPECT_EQ(load(0x0C, 1000), 1U) << "carried over, and nothing for the time in the pair";
  EXPECT_EQ(load(0x0C, 1010), 11U);
  timer.store(0x00, 1010, 1U << 31);
  EXPECT_EQ(load(0x08, 1020), 994U) << "off";
  EXPECT_EQ(load(0x0C, 1020), 11U);
}

TEST_F(ClusterTimerTest, HasNoEventThatNobodyWantsAndStandsAtTheReferenceClock) {
  timer.store(0x00, 0, 1);
  EXPECT_EQ(timer.next_tick(), kNoTick) << "it counts only";
  timer.store(0x00, 10, 0x85);
  EXPECT_TRUE(ClusterTimer::wants_reference_clock(0x00, 0x85));
  EXPECT_EQ(timer.next_tick(), kNoTick);
  EXPECT_EQ(load(0x08, 500), 10U);
}

class MchanTest : public testing::Test, public TransferListener {
 protected:
  static constexpr std::uint32_t kL1 = 0x10000000;

  MchanTest() {
    memory.add("l1", kL1, 0x10000);
    memory.add("l2", 0x1C000000, 0x10000);
  }
  void store(std::uint32_t offset, std::uint32_t value) {
    EXPECT_EQ(mchan.access(1, offset, &value, 0).kind, BusReply::Kind::done);
  }
  std::uint32_t load(std::uint32_t offset) { return mchan.access(1, offset, nullptr, 0).value; }
  void transfer_ended(unsigned /*who*/, std::uint32_t tag, std::uint64_t tick) override {
    if (const auto ended = mchan.ended(tag, tick); ended.raises_event) ++events;
  }
  void run() {
    Banks banks(16);
    while (dma.busy()) {
      dma.occupy(banks, dma.next_tick() + 1);
      dma.advance(dma.next_tick(), *this);
    }
  }
  std::vector<std::uint8_t> bytes(std::uint32_t address, std::size_t count) const {
    std::vector<std::uint8_t> read(count);
    memory.read(address, read);
    return read;
  }
  void fill(std::uint32_t address, std::size_t count) {
    std::vector<std::uint8_t> written(count);
    std::iota(written.begin(), written.end(), std::uint8_t{1});
    memory.write(address, written);
  }

  Memory memory;
  ClusterDma dma{memory, 0, {}};
  Mchan mchan{{kL1, 0x10000}, dma};
  int events = 0;
};

TEST_F(MchanTest, CopiesBytesAndCountsThemInItsCounter) {
  fill(0x1C000100, 40);
  const auto counter = load(0);
  EXPECT_EQ(counter, 0U);
  EXPECT_EQ(load(4), 1U << 16) << "taken, nothing to come";
  store(0, 40 | 1U << 16 | 1U << 17 | 1U << 19);  // 40 bytes into L1, with an event
  store(0, 0x200);                                // L1's address may be that of its alias
  EXPECT_FALSE(dma.busy()) << "the command is not complete";
  store(0, 0x1C000100);
  EXPECT_EQ(load(4), 1U << 16 | 1U);
  run();
  EXPECT_EQ(load(4), 1U << 16);
  EXPECT_EQ(events, 1);
  EXPECT_EQ(bytes(kL1 + 0x200, 40), bytes(0x1C000100, 40));
  store(4, 1U << counter);
  EXPECT_EQ(load(4), 0U);
}

TEST_F(MchanTest, CopiesRowsOutOfL1WithTheStepOfL2AndTellsOnlyWhenAllHaveCome) {
  fill(kL1, 20);
  load(0);
  store(0, 20 | 1U << 17 | 1U << 18 | 1U << 19);
  store(0, kL1);
  store(0, 0x1C000400);
  store(0, 0x100U << 16 | 8);  // rows of 8 bytes, 256 apart; the last one is half
  store(0, 4 | 1U << 17 | 1U << 19);
  store(0, kL1);
  store(0, 0x1C000800);
  run();
  EXPECT_EQ(events, 1) << "both count in one counter";
  EXPECT_EQ(bytes(0x1C000400, 8), bytes(kL1, 8));
  EXPECT_EQ(bytes(0x1C000500, 8), bytes(kL1 + 8, 8));
  EXPECT_EQ(bytes(0x1C000600, 4), bytes(kL1 + 16, 4));
  EXPECT_EQ(bytes(0x1C000604, 1).front(), 0U);
  EXPECT_EQ(bytes(0x1C000800, 4), bytes(kL1, 4));
}

TEST_F(MchanTest, HasAPlaceForAnyNumberOfCommandsAndNoneForMemoryThatIsNot) {
  fill(0x1C000000, 256);
  load(0);
  for (std::uint32_t i = 0; i < 40; ++i) {
    store(0, 4 | 1U << 16 | 1U << 17 | 1U << 19);
    store(0, 4 * i);
    store(0, 0x1C000000 + 4 * i);
  }
  run();
  EXPECT_EQ(events, 1);
  EXPECT_EQ(bytes(kL1, 160), bytes(0x1C000000, 160));
  store(0, 4 | 1U << 16 | 1U << 17);
  store(0, 0);
  const std::uint32_t nowhere = 0x1D000000;
  EXPECT_EQ(mchan.access(1, 0, &nowhere, 0).kind, BusReply::Kind::none);
}

/// Vectors, and where the fabric controller begins; the cluster's cores go to `core`.
constexpr std::string_view kBegin = R"(
    .balign 256
vectors: j fault
    .org vectors + 0x80
    .globl _start
_start: csrr a0, mhartid
    li a1, 0x400
    bne a0, a1, core
)";

/// Switches the cluster on; the cores that `who` names begin.
std::string start_cluster(std::uint32_t who) {
  return fmt::format(R"(
    li s0, 0x1A104000
    li a0, 8
    sw a0, 0x70(s0)
    li s0, 0x10200000
    la a1, vectors
    li a2, 8
    addi a3, s0, 0x40
1:  sw a1, 0(a3)
    addi a3, a3, 4
    addi a2, a2, -1
    bnez a2, 1b
    li a0, {}
    sw a0, 0x08(s0)
)",
                     who);
}

/// Switches the cluster on, lets eight cores begin, and waits for core 0's word. Each core copies 64 bytes of L2 into
/// L1, adds them up, and meets the others; core 0 adds what they found and sends it out.
std::string eight_cores() {
  return fmt::format("{}{}", kBegin, R"(
    li s1, 0x1C060000
    li s0, 0x1A104000
    li s2, 0x00204000
    li s3, 0x1A106000
    li a0, 0x7fffffff
    sw a0, 0x08(s3)        # hears event 31 of the SoC
    li a0, 0x08000002
    sw a0, 0x08(s2)        # events 1 and 27 end a wait
    li a0, 8
    sw a0, 0x70(s0)        # the cluster's power
    .insn i 0x03, 6, a1, 0x3c(s2)
    sw a1, 0(s1)
    li a3, 0x00200800
    lw a3, 0x700(a3)
    sw a3, 4(s1)
    li a4, 0x08000000
    sw a4, 0x28(s2)        # the queue is empty
    li s0, 0x10200000
    la a1, vectors
    li a2, 8
    addi a3, s0, 0x40
1:  sw a1, 0(a3)
    addi a3, a3, 4
    addi a2, a2, -1
    bnez a2, 1b
    li a0, 0xff
    sw a0, 0x08(s0)
    .insn i 0x03, 6, a1, 0x3c(s2)
    sw a1, 8(s1)
2:  .insn i 0x03, 6, a1, 0x3c(s2)
    j 2b

core: li s0, 0x00204000
    li s1, 0x10000000
    li a1, 0x10100
    sw a1, 0x08(s0)        # barrier and DMA end a wait
    li a1, 0xff
    sw a1, 0x200(s0)
    sw a1, 0x20c(s0)
    slli s2, a0, 6
    lw a1, 0x400(s0)       # a counter of the DMA
    li a2, 64 | 1 << 16 | 1 << 17 | 1 << 19
    sw a2, 0x400(s0)
    add a2, s1, s2
    sw a2, 0x400(s0)
    la a3, numbers
    add a3, a3, s2
    sw a3, 0x400(s0)
    li a4, 1
    sll a4, a4, a1
3:  lw a5, 0x404(s0)
    and a5, a5, a4
    beqz a5, 4f
    .insn i 0x03, 6, a5, 0x3c(s0)
    j 3b
4:  sw a4, 0x404(s0)
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
    .insn i 0x03, 6, a5, 0x21c(s0)
    bnez a0, 7f
    li a4, 0
    li a5, 8
    addi a6, s1, 0x400
6:  lw a7, 0(a6)
    add a4, a4, a7
    addi a6, a6, 4
    addi a5, a5, -1
    bnez a5, 6b
    li a6, 0x1C060000
    sw a4, 12(a6)
    li a6, 0x1B200E04
    sw zero, 0(a6)         # event 1 of the fabric controller
7:  sw zero, 0(s0)
8:  .insn i 0x03, 6, a5, 0x3c(s0)
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

BoardDescription gap8_board_of_cluster() {
  return read_board(MEBOTS_SOURCE_DIR "/configs/boards/gap8.json");
}

/// A program whose exceptions go to `ends`. The fabric controller goes on with `rest`, cores 1 and 5 at `core`.
std::string with_handler(std::string_view rest) {
  constexpr std::string_view kVectors = R"(
    .balign 256
vectors: j ends
    .org vectors + 0x80
    j begin
    .org vectors + 0x84
    j ends
    .globl _start
_start:
begin: csrr a0, mhartid
    li a1, 0x400
    bne a0, a1, core
)";
  return fmt::format("{}{}{}", kVectors, start_cluster(0b100010), rest);
}

TEST(Gap8Cluster, NamesTheFirstCoreInTimeWhoseExceptionEndsTheProgram) {
  BoardSystem system(with_handler(R"(
2:  j 2b
core: li a1, 1
    beq a0, a1, 3f
    .word 0
3:  .rept 4
    nop
    .endr
    .word 0
ends: csrr a1, mhartid
    li a2, 0x80000000
    add a2, a2, a1
    li a1, 0x1A1040A0
    sw a2, 0(a1)
4:  j 4b
)"),
                     {}, gap8_board_of_cluster());
  system.soc.advance(1 * kMs);
  EXPECT_EQ(system.soc.exit_code(), 5);
  EXPECT_EQ(system.soc.gave_up(), 5);
  ASSERT_EQ(system.faults.size(), 1U);
  EXPECT_THAT(system.faults.front(), testing::HasSubstr("cluster core 5: the program's own handler gave up"));
}

TEST(Gap8Cluster, BlamesNoCoreWhoseHandlerGoesOnAndEndsNothing) {
  BoardSystem system(with_handler(R"(
2:  j 2b
core: li a1, 1
    beq a0, a1, 4f
    li a1, 1000
3:  addi a1, a1, -1
    bnez a1, 3b
4:  .word 0
ends: csrr a1, mhartid
    li a2, 1
    beq a1, a2, 2b
    li a1, 0x1A1040A0
    li a2, 0x80000007
    sw a2, 0(a1)
5:  j 5b
)"),
                     {}, gap8_board_of_cluster());
  system.soc.advance(1 * kMs);
  EXPECT_EQ(system.soc.exit_code(), 7);
  EXPECT_EQ(system.soc.gave_up(), 5);
}

TEST(Gap8Cluster, BlamesNoCoreWhenTheFabricControllerEndsTheProgramWithoutAnException) {
  BoardSystem system(with_handler(R"(
    li a1, 10000
2:  addi a1, a1, -1
    bnez a1, 2b
    li a1, 0x1A1040A0
    li a2, 0x80000003
    sw a2, 0(a1)
core: .word 0
ends: j ends
)"),
                     {}, gap8_board_of_cluster());
  system.soc.advance(1 * kMs);
  EXPECT_EQ(system.soc.end(), End::exited);
  EXPECT_EQ(system.soc.exit_code(), 3);
  EXPECT_EQ(system.soc.gave_up(), std::nullopt);
  EXPECT_FALSE(system.soc.faulted());
  EXPECT_TRUE(system.faults.empty());
}

TEST(Gap8Cluster, RunsEightCoresWithDmaBarrierAndAWordToTheFabricController) {
  BoardSystem system(eight_cores(), {}, gap8_board_of_cluster());
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
  BoardSystem straight(eight_cores(), {}, gap8_board_of_cluster());
  Settings interpreted;
  interpreted.translate = false;
  BoardSystem slow(eight_cores(), interpreted, gap8_board_of_cluster());
  BoardSystem first(eight_cores(), {}, gap8_board_of_cluster());
  BoardSystem second(eight_cores(), {}, gap8_board_of_cluster());
  straight.soc.advance(1 * kMs);
  slow.soc.advance(1 * kMs);
  EXPECT_TRUE(mebots::test::same_state(slow.soc, straight.soc));
  first.soc.advance(15'000);  // cores are on their way
  state::restore(second.soc, state::save(first.soc));
  second.soc.advance(1 * kMs);
  EXPECT_TRUE(mebots::test::same_state(second.soc, straight.soc));
}

/// Of the two clock loops, in units of 32768 Hz.
struct Factors {
  std::uint32_t soc;
  std::uint32_t cluster;
};

/// Switches the cluster on; the cores that `who` names load 256 words of L2, each of them, and sleep.
std::string cores_that_load_from_l2(std::uint32_t who, const Factors& factors) {
  const auto clocks = fmt::format(R"(
    li s0, 0x1A100000
    li a0, 1 << 26 | {}
    sw a0, 0x04(s0)
    li a0, 1 << 26 | {}
    sw a0, 0x14(s0)
)",
                                  factors.soc, factors.cluster);
  constexpr std::string_view kLoad = R"(
    li s1, 0x1C040000
    li a2, 256
2:  lw a0, 0(s1)
    addi a2, a2, -1
    bnez a2, 2b
3:  wfi
    j 3b
core: li s1, 0x1C040000
    li a2, 256
4:  lw a0, 0(s1)
    addi a2, a2, -1
    bnez a2, 4b
    li s0, 0x00204000
5:  .insn i 0x03, 6, a5, 0x3c(s0)
    j 5b
fault: j fault
)";
  return fmt::format("{}{}{}{}", kBegin, clocks, start_cluster(who), kLoad);
}

std::uint64_t cycles_of_core(std::uint32_t who, const Factors& factors, unsigned core,
                             const BoardDescription& board = gap8_board_of_cluster()) {
  BoardSystem system(cores_that_load_from_l2(who, factors), {}, board);
  system.soc.advance(20 * kMs);
  EXPECT_TRUE(system.faults.empty()) << system.faults.front();
  EXPECT_TRUE(system.soc.hart(1 + core).sleeping());
  return system.soc.hart(1 + core).counters().cycles;
}

/// An addition and a taken branch, and the load itself, beside what it waits.
constexpr std::uint64_t kLoads = 256;
constexpr std::uint64_t kLoopCycles = 5;

TEST(Gap8Cluster, CountsTheWayToL2InTheClocksOfClusterAndSoc) {
  // Beginning, end, and the refills of the instruction cache, which wait as long as loads.
  const auto around = [](double way) { return 20 + 10 * way; };
  const auto expect_way = [&](const Factors& factors, std::uint64_t way) {
    EXPECT_NEAR(static_cast<double>(cycles_of_core(1, factors, 0)), static_cast<double>(kLoads * (kLoopCycles + way)),
                around(static_cast<double>(way)))
        << factors.soc << " " << factors.cluster;
  };
  expect_way({1500, 1500}, 2 + 17);
  expect_way({1500, 3000}, 2 + 2 * 17);
  expect_way({3000, 1500}, 2 + 9);
  expect_way({600, 4800}, 2 + 8 * 17);
}

TEST(Gap8Cluster, LetsOneCoreAtATimeThroughToL2) {
  // A cycle of the SoC is 8 of the cluster, which each access takes for itself. With the way as it is eight accesses
  // fit behind each other while one is on its way.
  const Factors factors{600, 4800};
  EXPECT_LT(cycles_of_core(0xff, factors, 7), cycles_of_core(1, factors, 0) * 5 / 4);
  auto board = gap8_board_of_cluster();
  for (auto& memory : board.memories) {
    if (memory.way) memory.way->soc = 1;
  }
  EXPECT_LT(cycles_of_core(1, factors, 0, board), kLoads * 24);
  EXPECT_GE(cycles_of_core(0xff, factors, 7, board), kLoads * 8 * 8 * 9 / 10) << "eight loads take 64 cycles";
}

/// Straight code that accesses L2 until no table of banks reaches as far, and then L1, where others are.
TEST(Gap8Cluster, TranslatedCodeWaitsForL2HoweverLong) {
  struct Mix {
    unsigned far;
    unsigned near;
  };
  const auto program = [](std::uint32_t who, const Factors& factors, const Mix& mix) {
    return fmt::format(R"({}
    li s0, 0x1A100000
    li a0, 1 << 26 | {}
    sw a0, 0x04(s0)
    li a0, 1 << 26 | {}
    sw a0, 0x14(s0)
    {}
3:  wfi
    j 3b
core: csrr s2, mhartid
    andi s2, s2, 15
    li s1, 0x1C040000
    li s0, 0x10000000
    andi a2, s2, 1
    bnez a2, 5f
4:  .rept {}
    lw a0, 0(s1)
    .endr
    .rept {}
    sw a0, 0(s0)
    .endr
    sw a1, 4(s1)
    addi a1, a1, 1
    j 4b
5:  .rept 50
    sw a0, 0(s0)
    .endr
    j 5b
fault: j fault
)",
                       kBegin, factors.soc, factors.cluster, start_cluster(who), mix.far, mix.near);
  };
  for (const auto& mix : {Mix{60, 0}, Mix{51, 12}, Mix{30, 30}, Mix{13, 50}, Mix{6, 57}}) {
    for (const auto& factors : {Factors{1500, 1500}, Factors{600, 4800}, Factors{150, 4800}, Factors{80, 4800}}) {
      for (const std::uint32_t who : {1U, 3U, 0xffU}) {
        const auto elf = BoardSystem::assembled(program(who, factors, mix));
        BoardSystem system(elf, {}, gap8_board_of_cluster());
        Settings without_translation;
        without_translation.translate = false;
        BoardSystem interpreted(elf, without_translation, gap8_board_of_cluster());
        for (int ms = 10; ms <= 40; ms += 10) {
          for (auto* each : {&system, &interpreted}) each->soc.advance(ms * kMs);
          ASSERT_TRUE(mebots::test::same_state(interpreted.soc, system.soc))
              << mix.far << " and " << mix.near << ", clocks " << factors.soc << " and " << factors.cluster
              << ", cores " << who << ", " << ms << " ms";
        }
        const auto& core = system.soc.hart(1);
        EXPECT_TRUE(!translate::can_translate() || core.code().instructions_translated() > 30);
        EXPECT_GT(core.counters().far_accesses, 1000U) << factors.soc;
      }
    }
  }
}

TEST(Gap8Cluster, LetsTheFabricControllerWaitForL2AndNotForItsOwnMemory) {
  const auto cycles_from = [](std::uint32_t address) {
    BoardSystem system(fmt::format(R"(
_start: li s1, {}
    li a2, 256
1:  lw a0, 0(s1)
    addi a2, a2, -1
    bnez a2, 1b
2:  wfi
    j 2b
)",
                                   address),
                       {}, gap8_board_of_cluster());
    system.soc.advance(1 * kMs);
    return system.soc.hart().counters().cycles;
  };
  EXPECT_EQ(cycles_from(0x1C040000) - cycles_from(0x1B000000), kLoads * 8);
}

TEST_F(MchanTest, TakesAsLongAsTheSlowerClockNeedsForItsBeats) {
  const auto ticks_for = [this](std::uint32_t soc_ticks_of_two_beats) {
    DmaTiming timing;
    timing.beat_ticks = soc_ticks_of_two_beats * DmaTiming::kBeatUnit / 2;
    ClusterDma slow{memory, 0, timing};
    ClusterDma::Draft what;
    what.l2 = 0x1C000000;
    what.l1 = kL1;
    what.size = 4096;
    EXPECT_TRUE(slow.enqueue(0, what, false, 0));
    return slow.next_tick();
  };
  EXPECT_EQ(ticks_for(2), 16U + 512);
  EXPECT_EQ(ticks_for(3), 16U + 512 * 3 / 2);
  EXPECT_EQ(ticks_for(4), 16U + 512 * 2);
}

/// Each core adds 20 times 1 to a word of L1, between taking a lock by test and set and giving it back. The last one to
/// come stores characters, by bytes, where programs for simulators print.
constexpr std::string_view kLocks = R"(
2:  wfi
    j 2b
core: li s0, 0x00204000
    li s1, 0x10000100      # the lock
    li s2, 0x00100100      # where it is tested and set, by the cores' alias
    li a2, 20
3:  lw a3, 0(s2)
    bnez a3, 3b
    lw a4, 4(s1)
    addi a4, a4, 1
    sw a4, 4(s1)
    sw zero, 0(s1)
    addi a2, a2, -1
    bnez a2, 3b
    li a5, 160
    bne a4, a5, 4f
    li a6, 0x1C060000
    sw a4, 0(a6)
    lw a3, 0(s2)
    sw a3, 4(a6)
    li s2, 0x10100100      # the long way
    lw a3, 0(s2)
    sw a3, 8(a6)
    li a6, 0x1A110000
    li a5, 'o'
    sb a5, 0(a6)
    li a5, 'k'
    sh a5, 4(a6)
    li a5, 10
    sb a5, 1(a6)
4:  .insn i 0x03, 6, a5, 0x3c(s0)
    j 4b
fault: j fault
)";

TEST(Gap8Cluster, LocksByTestAndSetAndStoresBytesIntoDevicesOfTheSoc) {
  BoardSystem system(fmt::format("{}{}{}", kBegin, start_cluster(0xff), kLocks), {}, gap8_board_of_cluster());
  system.soc.advance(5 * kMs);
  EXPECT_TRUE(system.faults.empty()) << system.faults.front();
  EXPECT_EQ(system.result(0), 160U);
  EXPECT_EQ(system.result(1), 0U) << "it was free";
  EXPECT_EQ(system.result(2), 0xffffffffU) << "taken by the load before";
  EXPECT_EQ(system.console, std::vector<std::string>{"ok"});
}

/// Core 0 loads 256 times and stores once at `offset` behind `base`, and sleeps.
BoardSystem core_that_reads(std::string_view base, std::string_view offset) {
  const auto reads = fmt::format(R"(
2:  wfi
    j 2b
core: li s1, {0}
    li a2, 256
3:  lw a0, {1}(s1)
    addi a2, a2, -1
    bnez a2, 3b
    sw a0, {1}(s1)
    li s0, 0x00204000
4:  .insn i 0x03, 6, a5, 0x3c(s0)
    j 4b
fault: j fault
)",
                                 base, offset);
  return BoardSystem(fmt::format("{}{}{}", kBegin, start_cluster(1), reads), {}, gap8_board_of_cluster());
}

TEST(Gap8Cluster, GoesOnWhereNoDeviceStandsAndWaitsAsLongAsForOne) {
  auto modelled = core_that_reads("0x1A104000", "0x70");
  auto nowhere = core_that_reads("0x1A103000", "0x04");
  modelled.soc.advance(5 * kMs);
  nowhere.soc.advance(5 * kMs);
  EXPECT_TRUE(modelled.faults.empty()) << modelled.faults.front();
  ASSERT_EQ(nowhere.faults.size(), 1U);
  EXPECT_THAT(nowhere.faults[0], testing::HasSubstr("load from 0x1a103004 in a core of the cluster"));
  EXPECT_FALSE(nowhere.soc.faulted());
  EXPECT_TRUE(nowhere.soc.hart(1).sleeping());
  EXPECT_EQ(nowhere.soc.hart(1).counters().cycles, modelled.soc.hart(1).counters().cycles);
}

/// Core 0 sets the cluster's timer to 1000 ticks and wakes with core 1 by its event; core 2 takes the same as an
/// interrupt. Each stores what the timer has counted then.
constexpr std::string_view kTimed = R"(
2:  wfi
    j 2b
core: li s0, 0x00204000
    li s1, 0x00200400      # the timer
    li s3, 0x1C060000
    csrr a0, mhartid
    slli a1, a0, 2
    add s3, s3, a1
    li a1, 1 << 10
    li a2, 2
    beq a0, a2, 4f
    sw a1, 0x08(s0)
    bnez a0, 3f
    li a1, 1000
    sw a1, 0x10(s1)
    li a1, 0x07            # from 0, with its event
    sw a1, 0(s1)
3:  .insn i 0x03, 6, a4, 0x3c(s0)
    lw a5, 0x08(s1)
    sw a5, 0(s3)
    sw a4, 0x20(s3)
5:  .insn i 0x03, 6, a4, 0x3c(s0)
    j 5b
4:  sw a1, 0x14(s0)
    csrsi mstatus, 8
6:  j 6b                   # awake, so that only the interrupt ends it
fault: csrr a0, mcause
    lw a5, 0x08(s1)
    sw a5, 0(s3)
    sw a0, 0x20(s3)
    j 5b
)";

/// A program of these cores, whose exceptions and interrupts all lead to `fault`.
BoardSystem timed_system(unsigned cores, std::string_view code, const Settings& settings = {}) {
  auto board = gap8_board_of_cluster();
  board.instruction_caches = {};  // refills would come between the event and what is read
  const auto vectors = std::string(kBegin).replace(kBegin.find("j fault"), 7, ".rept 32\n j fault\n .endr");
  return BoardSystem(fmt::format("{}{}{}", vectors, start_cluster(cores), code), settings, board);
}

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

/// The only core that is awake sets the timer to 100 ticks and spins. What comes stores the timer's count.
constexpr std::string_view kTimedAlone = R"(
2:  wfi
    j 2b
core: li s0, 0x00204000
    li s1, 0x00200400      # the timer
    li s3, 0x1C060000
    li a1, 1 << 10
    sw a1, 0x14(s0)
    csrsi mstatus, 8
    li a1, 100
    sw a1, 0x10(s1)
    li a1, 0x07            # from 0, with its event
    sw a1, 0(s1)
3:  j 3b
fault: csrr a0, mcause
    lw a5, 0x08(s1)
    sw a5, 0(s3)
    sw a0, 4(s3)
4:  .insn i 0x03, 6, a4, 0x3c(s0)
    j 4b
)";

TEST(Gap8Cluster, InterruptsInTimeTheCoreThatSetTheTimerAndIsAwakeAlone) {
  auto system = timed_system(1, kTimedAlone);
  system.soc.advance(5 * kMs);
  EXPECT_TRUE(system.faults.empty()) << system.faults.front();
  EXPECT_EQ(system.result(1), 0x80000000U | 10U);
  EXPECT_GE(system.result(0), 100U);
  EXPECT_LE(system.result(0), 116U);
}

/// Cores 0 and 1 loop; the end of a transfer interrupts core 0, which starts the next one, 16 times in all.
constexpr std::string_view kTransfers = R"(
2:  wfi
    j 2b
core: li s0, 0x00204000
    li s1, 0x1C060000
    li s2, 0               # transfers that have ended
    bnez a0, 3f
    li a1, 1 << 8
    sw a1, 0x14(s0)
    j next
3:  addi a2, a2, 1         # hot, and without an access
    j 3b
fault: csrr a1, mcause
    addi s2, s2, 1
    sw s2, 0(s1)
    sw a1, 4(s1)
    li a1, 16
    beq s2, a1, 4f
next: lw a1, 0x400(s0)
    li a1, 4096 | 1 << 16 | 1 << 17 | 1 << 19
    sw a1, 0x400(s0)
    li a1, 0x10000000
    sw a1, 0x400(s0)
    li a1, 0x1C000000
    sw a1, 0x400(s0)
    la a1, 3b
    csrw mepc, a1
    li a1, 0x80
    csrs mstatus, a1
    mret
4:  .insn i 0x03, 6, a4, 0x3c(s0)
    j 4b
)";

TEST(Gap8Cluster, InterruptsACoreAtTheEndOfATransferAsItRunsTranslatedWithAnother) {
  auto translated = timed_system(0b11, kTransfers);
  auto interpreted = timed_system(0b11, kTransfers, {.translate = false});
  translated.soc.advance(1 * kMs);
  interpreted.soc.advance(1 * kMs);
  EXPECT_TRUE(translated.faults.empty()) << translated.faults.front();
  EXPECT_EQ(translated.result(0), 16U);
  EXPECT_EQ(translated.result(1), 0x80000000U | 8U);
  EXPECT_TRUE(mebots::test::same_state(translated.soc, interpreted.soc));
}

TEST(Gap8Cluster, KeepsTheTimersEventOverASavedState) {
  const auto program = fmt::format("{}{}{}", kBegin, start_cluster(0b11), kTimed);
  BoardSystem straight(program, {}, gap8_board_of_cluster());
  straight.soc.advance(1 * kMs);
  EXPECT_EQ(straight.result(8), 1U << 10);
  BoardSystem first(program, {}, gap8_board_of_cluster());
  BoardSystem second(program, {}, gap8_board_of_cluster());
  first.soc.advance(25'000);  // all cores wait
  ASSERT_EQ(first.result(8), 0U);
  ASSERT_TRUE(first.soc.hart(1).sleeping());
  state::restore(second.soc, state::save(first.soc));
  second.soc.advance(1 * kMs);
  EXPECT_TRUE(mebots::test::same_state(second.soc, straight.soc));
}

TEST(Gap8Cluster, LetsTheFabricControllerReadTheClustersTimer) {
  BoardSystem system(R"(
_start: li s0, 0x1A104000
    li a0, 8
    sw a0, 0x70(s0)
    li s0, 0x10200000
    li a0, 3
    sw a0, 0x400(s0)
    lw a1, 0x408(s0)
    lw a2, 0x408(s0)
    li s1, 0x1C060000
    sw a1, 0(s1)
    sw a2, 4(s1)
    li a0, 0x83
    sw a0, 0x400(s0)
2:  j 2b
)",
                     {}, gap8_board_of_cluster());
  system.soc.advance(1 * kMs);
  EXPECT_GT(system.result(1), system.result(0));
  ASSERT_EQ(system.faults.size(), 1U);
  EXPECT_THAT(system.faults[0], testing::HasSubstr("reference clock is not modelled"));
}

/// What others do while core 0 works: the fabric controller, and the cores that `cores` names beside it.
enum class Meanwhile : std::uint8_t { sleeps, spins };
struct Others {
  Meanwhile controller = Meanwhile::sleeps;
  std::uint32_t cores = 0;
  Meanwhile of_cores = Meanwhile::sleeps;
};

/// Core 0 loops 200,000 times, does what `change` says, and loops as often again. Then it stores into tohost.
std::string core_that_changes(std::string_view change, const Others& others) {
  return fmt::format(R"({}{}
2:  {}
    j 2b
core: bnez a0, 6f
    li t0, 200000
3:  addi t0, t0, -1
    bnez t0, 3b
    {}
    li t0, 200000
4:  addi t0, t0, -1
    bnez t0, 4b
    la t0, tohost
    li t1, 1
    sw t1, 0(t0)
5:  j 5b
6:  li s0, 0x00204000
7:  {}
    j 7b
fault: j fault
    .section .tohost, "aw", @progbits
    .balign 64
    .globl tohost
tohost: .word 0, 0
)",
                     kBegin, start_cluster(1 | others.cores), others.controller == Meanwhile::sleeps ? "wfi" : "nop",
                     change, others.of_cores == Meanwhile::sleeps ? ".insn i 0x03, 6, a5, 0x3c(s0)" : "nop");
}

/// Cycles of one of its two loops.
constexpr double kLoopOfWork = 200'000 * 4.0;
constexpr double kHzAtReset = 1525 * 32768.0;

/// The cluster's clock, from a core or from the fabric controller.
std::string set_cluster_clock(std::uint32_t factor) {
  return fmt::format("li s0, 0x1A100000\n li a0, 1 << 26 | {}\n sw a0, 0x14(s0)", factor);
}

void run_to_tohost(BoardSystem& system) {
  system.soc.program_host().watch(*system.soc.program().symbol("tohost"));
  system.soc.run_cycles(10'000'000);
}

TEST(Gap8Cluster, ACoreSetsTheClockNowWhateverOthersDo) {
  const auto run = [](std::uint32_t factor, const Others& others) {
    BoardSystem system(core_that_changes(set_cluster_clock(factor), others), {}, gap8_board_of_cluster());
    run_to_tohost(system);
    EXPECT_EQ(system.soc.end(), End::host);
    const auto expected_s = kLoopOfWork / kHzAtReset + kLoopOfWork / (factor * 32768.0);
    EXPECT_NEAR(static_cast<double>(system.soc.now()) / kPsPerS, expected_s, 1e-3 * expected_s)
        << factor << ", controller " << static_cast<int>(others.controller) << ", cores " << others.cores;
    return system.soc.energy();
  };
  for (const std::uint32_t factor : {762U, 3050U}) {
    for (const std::uint32_t cores : {0U, 0b10U}) {
      const auto beside = run(factor, {Meanwhile::spins, cores, Meanwhile::spins});
      const auto alone = run(factor, {Meanwhile::sleeps, cores, Meanwhile::spins});
      for (const auto part : {Part::cluster_background, Part::cluster_cores, Part::leakage}) {
        EXPECT_GT(beside[part], 0);
        EXPECT_NEAR(alone[part], beside[part], 1e-3 * beside[part])
            << factor << ", cores " << cores << ", part " << static_cast<int>(part);
      }
    }
  }
}

TEST(Gap8Cluster, ACoreThatChangesTheClockGivesTheSameBitsInStepsInterpretedAndFromAState) {
  const auto program = core_that_changes(set_cluster_clock(762), {Meanwhile::sleeps, 0xfe, Meanwhile::sleeps});
  const auto board = gap8_board_of_cluster();
  BoardSystem straight(program, {}, board);
  Settings interpreted;
  interpreted.translate = false;
  BoardSystem slow(program, interpreted, board);
  BoardSystem steps(program, {}, board);
  BoardSystem second(program, {}, board);
  straight.soc.advance(30 * kMs);
  slow.soc.advance(30 * kMs);
  EXPECT_TRUE(mebots::test::same_state(slow.soc, straight.soc));
  double last_j = 0;
  for (std::int64_t time = 0; time < 20 * kMs; time += 7'919) {
    steps.soc.advance(time);
    const auto total_j = steps.soc.energy().total_j();
    ASSERT_GE(total_j, last_j) << "at " << time << " ns";
    last_j = total_j;
  }
  state::restore(second.soc, state::save(steps.soc));
  for (auto* system : {&steps, &second}) {
    system->soc.advance(30 * kMs);
    EXPECT_TRUE(mebots::test::same_state(system->soc, straight.soc));
  }
}

TEST(Gap8Cluster, RunLastsUntilACoreSwitchesTheClusterOff) {
  BoardSystem system(core_that_changes("li s0, 0x1A104000\n sw zero, 0x70(s0)", {}), {}, gap8_board_of_cluster());
  run_to_tohost(system);
  EXPECT_EQ(system.soc.end(), End::none) << "nothing can go on";
  EXPECT_FALSE(system.soc.cluster()->powered());
  const auto expected_s = kLoopOfWork / kHzAtReset;
  const auto now = system.soc.now();
  EXPECT_NEAR(static_cast<double>(now) / kPsPerS, expected_s, 1e-3 * expected_s);
  EXPECT_NEAR(static_cast<double>(system.soc.cluster()->powered_time(now)) / kPsPerS, expected_s, 1e-3 * expected_s);
  EXPECT_GT(static_cast<double>(system.soc.sleep_time()) / kPsPerS, 0.99 * expected_s);
}

/// Firmware may change clocks for each picture. What a load from L2 and a cache line take in the cluster's cycles then
/// changes, and no code does.
TEST(Gap8Cluster, CodeIsDecodedAndTranslatedOnceWhateverTheClocks) {
  const auto program =
      BoardSystem::assembled(fmt::format(R"({}{}
2:  li a2, 200
3:  addi a2, a2, -1
    bnez a2, 3b
    {}
    li a2, 200
4:  addi a2, a2, -1
    bnez a2, 4b
    {}
    j 2b
core: li s1, 0x1C040000
5:  lw a0, 0(s1)
    addi a1, a1, 1
    addi a1, a1, 1
    addi a1, a1, 1
    j 5b
fault: j fault
)",
                                         kBegin, start_cluster(0xff), set_cluster_clock(762), set_cluster_clock(3050)));
  BoardSystem system(program, {}, gap8_board_of_cluster());
  Settings without_translation;
  without_translation.translate = false;
  BoardSystem interpreted(program, without_translation, gap8_board_of_cluster());
  BoardSystem restored(program, {}, gap8_board_of_cluster());
  system.soc.advance(10 * kMs);
  const auto& controller = system.soc.hart().code();
  const auto& cluster = system.soc.cluster()->hart(0).code();
  const auto decoded = controller.blocks.decoded() + cluster.blocks.decoded();
  const auto translated = controller.instructions_translated() + cluster.instructions_translated();
  if (translate::can_translate()) {
    EXPECT_GT(cluster.instructions_translated(), 0U);
    EXPECT_GT(controller.instructions_translated(), 0U);
  }
  state::restore(restored.soc, state::save(system.soc));
  for (int ms = 11; ms <= 30; ++ms) {
    for (auto* each : {&system, &interpreted, &restored}) each->soc.advance(ms * kMs);
    ASSERT_TRUE(mebots::test::same_state(interpreted.soc, system.soc)) << ms;
    ASSERT_TRUE(mebots::test::same_state(restored.soc, system.soc)) << ms;
  }
  EXPECT_GT(system.soc.hart().counters().instructions, 100'000U) << "hundreds of changes";
  EXPECT_EQ(controller.blocks.decoded() + cluster.blocks.decoded(), decoded);
  EXPECT_EQ(controller.instructions_translated() + cluster.instructions_translated(), translated);
}

/// A core that slept before the clock changed has a tick of the old one.
TEST(Gap8Cluster, CoresThatSleepHaveATimeThoughTheClockHasChangedSince) {
  BoardSystem by_core(core_that_changes(set_cluster_clock(762), {Meanwhile::sleeps, 0b10}), {},
                      gap8_board_of_cluster());
  run_to_tohost(by_core);
  EXPECT_LE(by_core.soc.core_time(2), by_core.soc.now());
  const auto program = fmt::format(R"({}{}
    li t0, 10000
2:  addi t0, t0, -1
    bnez t0, 2b
    {}
3:  wfi
    j 3b
core: li s0, 0x00204000
4:  .insn i 0x03, 6, a5, 0x3c(s0)
    j 4b
fault: j fault
)",
                                   kBegin, start_cluster(1), set_cluster_clock(762));
  BoardSystem by_controller(program, {}, gap8_board_of_cluster());
  by_controller.soc.run_cycles(10'000'000);
  EXPECT_EQ(by_controller.soc.now(), by_controller.soc.core_time());
}

/// Eight cores load one word of L1 256 times each, which they see at `address`; cycles of the slowest.
std::uint64_t cycles_of_one_bank(std::string_view address) {
  const auto loads = fmt::format(R"(
    .option norvc          # the code is as long with either address
2:  wfi
    j 2b
core: li s0, 0x00204000
    li s1, {}
    li a2, 256
3:  lw a0, 0(s1)
    addi a2, a2, -1
    bnez a2, 3b
4:  .insn i 0x03, 6, a5, 0x3c(s0)
    j 4b
fault: j fault
)",
                                 address);
  BoardSystem system(fmt::format("{}{}{}", kBegin, start_cluster(0xff), loads), {}, gap8_board_of_cluster());
  system.soc.advance(5 * kMs);
  EXPECT_TRUE(system.faults.empty()) << system.faults.front();
  std::uint64_t longest = 0;
  for (unsigned core = 1; core <= 8; ++core) longest = std::max(longest, system.soc.hart(core).counters().cycles);
  return longest;
}

TEST(Gap8Cluster, WaitsForABankOfL1ByItsAliasAsByItsAddress) {
  constexpr std::uint64_t kOneWordACycle = 8U * 256;
  // Cores come to the end of a quantum at other instructions, so that they take the bank in another order.
  constexpr std::uint64_t kMost = kOneWordACycle * 11 / 10;
  for (const auto* address : {"0x10001100", "0x00001100"}) {
    const auto cycles = cycles_of_one_bank(address);
    EXPECT_GE(cycles, kOneWordACycle) << address;
    EXPECT_LE(cycles, kMost) << address;
  }
}

TEST(Gap8Cluster, SocControlTellsHowManyCoresThisChipHas) {
  constexpr std::string_view kProgram = R"(
_start: li s0, 0x1A104000
    lw a0, 0(s0)
    li t0, 0x1C060000
    sw a0, 0(t0)
2:  j 2b
)";
  for (const auto& [cores, info] : {std::pair{8U, 0x80001U}, std::pair{1U, 0x10001U}, std::pair{0U, 0U}}) {
    Settings settings;
    settings.cluster_cores = cores;
    BoardSystem system(kProgram, settings, gap8_board_of_cluster());
    system.soc.advance(1 * kMs);
    EXPECT_EQ(system.result(0), info) << cores;
  }
}

TEST(Gap8Cluster, TellsOnceOfARegisterThatIsNotModelled) {
  BoardSystem system(R"(
_start: li s0, 0x1A104000
    li a0, 8
    sw a0, 0x70(s0)
    li s0, 0x10200000
    li a1, 3
1:  lw a0, 0x300(s0)
    addi a1, a1, -1
    bnez a1, 1b
2:  j 2b
)",
                     {}, gap8_board_of_cluster());
  system.soc.advance(1 * kMs);
  ASSERT_EQ(system.faults.size(), 1U);
  EXPECT_THAT(system.faults[0], testing::HasSubstr("cluster: load from 0x10200300 by the fabric controller"));
}

}  // namespace
}  // namespace mebots::soc::test
