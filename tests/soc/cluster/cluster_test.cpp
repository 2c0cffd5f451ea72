// SPDX-License-Identifier: Apache-2.0
#include "board_system.hpp"
#include "hart/observer.hpp"

#include "mebots/error.hpp"
#include "support/same_state.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>
#include <utility>

namespace mebots::soc::test {
namespace {

constexpr double kClusterHz = 87e6;  // clock at the start

/// Runs both systems up to `end_ns`. Their states and energies must be equal after each step.
void expect_same_bits(Soc& one, Soc& other, std::int64_t step_ns, std::int64_t end_ns) {
  for (auto t = one.now() / 1000 + step_ns; t < end_ns; t += step_ns) {
    one.advance(t);
    other.advance(t);
    ASSERT_TRUE(mebots::test::same_state(one, other)) << "at " << t << " ns";
    ASSERT_EQ(one.energy().total_j(), other.energy().total_j()) << "at " << t << " ns";
  }
}

/// Returns a system whose fabric controller switches the cluster on and sleeps. Each core runs `body` with its number
/// in s0, and stores its cycles in result(number).
BoardSystem cores_run(std::string_view body, unsigned cores, bool translate = true,
                      const BoardDescription& board = BoardSystem::without_caches()) {
  Settings settings;
  settings.cluster_cores = cores;
  settings.translate = translate;
  return BoardSystem(BoardSystem::assembled(fmt::format(R"(
_start: li s0, POWER_MANAGER_BASE
    la a0, core
    sw a0, POWER_MANAGER_CLUSTER_BOOT_OFFSET(s0)
    li a0, 1
    sw a0, POWER_MANAGER_CLUSTER_POWER_OFFSET(s0)
1:  wfi
    j 1b
core: csrr s0, mhartid
    li s1, L1_BASE
    csrr s10, mcycle
{}
    csrr s11, mcycle
    sub s11, s11, s10
    li t0, 0x1C060000
    slli t1, s0, 2
    add t0, t0, t1
    sw s11, 0(t0)
2:  wfi
    j 2b
)",
                                                        body)),
                     settings, board);
}

/// The program has 256 loads. Without conflicts, each takes one cycle.
constexpr std::string_view kHammer = ".rept 128\n lw a1, 0(a0)\n lw a2, 0(a0)\n.endr\n";

std::vector<std::uint32_t> cycles_of(std::string_view body, unsigned cores,
                                     const BoardDescription& board = BoardSystem::without_caches()) {
  auto system = cores_run(body, cores, true, board);
  system.soc.advance(1'000'000);
  std::vector<std::uint32_t> cycles;
  for (unsigned core = 0; core < cores; ++core) cycles.push_back(system.result(core));
  return cycles;
}

/// The store that switches the cluster on waits for the power manager's latency. The cluster is on when the store ends.
TEST(ClusterEnergy, CanBeReadDuringTheInstructionThatSwitchesItOn) {
  auto system = cores_run("", 1);
  double last_j = 0;
  bool was_off = false;
  for (std::int64_t t = 1; t < 1000; ++t) {
    system.soc.advance(t);
    const auto total_j = system.soc.energy().total_j();
    EXPECT_GE(total_j, last_j) << "at " << t << " ns";
    last_j = total_j;
    was_off = was_off || !system.soc.cluster()->powered();
  }
  EXPECT_TRUE(was_off && system.soc.cluster()->powered());
}

TEST(ClusterBanks, OneCoreAloneNeverWaits) {
  EXPECT_EQ(cycles_of("mv a0, s1\n" + std::string(kHammer), 1)[0], 256U + 2U) << "and the move and one counter read";
}

TEST(ClusterBanks, TwoCoresOnOneBankTakeTwiceAsLong) {
  const auto cycles = cycles_of("mv a0, s1\n" + std::string(kHammer), 2);
  const auto last = std::max(cycles[0], cycles[1]);
  EXPECT_GE(last, 512U);
  EXPECT_LE(last, 512U + 4U) << "the bank is never idle: it serves 512 words, one a cycle";
}

TEST(ClusterBanks, EightCoresOnOneBankTakeEightTimesAsLong) {
  const auto cycles = cycles_of("mv a0, s1\n" + std::string(kHammer), 8);
  const auto last = *std::max_element(cycles.begin(), cycles.end());
  EXPECT_GE(last, 8 * 256U);
  EXPECT_LE(last, 8 * 256U + 10U);
}

TEST(ClusterBanks, CoresOnSeparateBanksDoNotWait) {
  // Neighbouring words are in neighbouring banks.
  const auto cycles = cycles_of("slli a0, s0, 2\n add a0, a0, s1\n" + std::string(kHammer), 8);
  for (const auto own : cycles) EXPECT_EQ(own, 256U + 3U);
}

TEST(ClusterBanks, SixteenWordsApartIsTheSameBank) {
  const auto cycles = cycles_of("slli a0, s0, 6\n add a0, a0, s1\n" + std::string(kHammer), 2);
  EXPECT_GE(std::max(cycles[0], cycles[1]), 512U);
}

BoardDescription with_tree(BoardDescription board) {
  for (auto& memory : board.memories) memory.arbitration_tree = memory.place == Place::cluster;
  return board;
}

/// Returns a loop of `turns` iterations. Each iteration loads one word 16 times, without any cycle between the loads.
std::string hammer(unsigned turns) {
  return fmt::format(
      "mv a0, s1\n.balign 4\n.option push\n.option norvc\nli a3, {}\n.insn i 0x7b, 4, x0, a3, 32\n"
      ".rept 8\n lw a1, 0(a0)\n lw a2, 0(a0)\n.endr\n.option pop\n",
      turns);
}

/// Returns the cycles of cores that load one word in every cycle, by the rule of the RTL: the bank counts its grants
/// modulo the cores, and serves the core with the least value of number XOR count.
std::vector<std::uint32_t> cycles_by_tree(unsigned cores, std::uint32_t loads) {
  std::vector<std::uint32_t> left(cores, loads);
  std::vector<std::uint32_t> end(cores, 0);
  for (std::uint32_t cycle = 0; cycle < cores * loads; ++cycle) {
    unsigned first = cores;
    for (unsigned core = 0; core < cores; ++core) {
      if (left[core] == 0) continue;
      if (first == cores || (core ^ cycle % cores) < (first ^ cycle % cores)) first = core;
    }
    if (--left[first] == 0) end[first] = cycle + 1;
  }
  return end;
}

TEST(ClusterBanks, ATreeServesCoresInTurn) {
  constexpr unsigned kTurns = 64;
  for (const unsigned cores : {2, 3, 4, 8}) {
    const auto cycles = cycles_of(hammer(kTurns), cores, with_tree(BoardSystem::without_caches()));
    const auto expected = cycles_by_tree(cores, 16 * kTurns);
    for (unsigned core = 0; core < cores; ++core) {
      EXPECT_NEAR(cycles[core], expected[core], 0.05 * expected[core]) << core << " of " << cores;
    }
  }
}

/// With arbitration by a tree, two cores take turns at a bank even if the cluster has eight cores.
TEST(ClusterBanks, ATreeServesTwoOfEightCoresInTurn) {
  const auto body = "li t0, 2\nblt s0, t0, 4f\n3: wfi\nj 3b\n4:\n" + hammer(64);
  const auto rotating = cycles_of(body, 8, BoardSystem::without_caches());
  const auto by_tree = cycles_of(body, 8, with_tree(BoardSystem::without_caches()));
  EXPECT_LT(rotating[0], 0.8 * rotating[1]) << "core 0 is first in seven of eight quanta";
  EXPECT_NEAR(by_tree[0], by_tree[1], 0.04 * by_tree[1]);
  EXPECT_NEAR(by_tree[1], 2048, 16);
}

BoardDescription with_quantum(std::uint32_t quantum) {
  auto board = with_tree(BoardSystem::without_caches());
  for (auto& memory : board.memories) {
    if (memory.place == Place::cluster) memory.quantum = quantum;
  }
  return board;
}

/// If all 256 loads fit into one quantum, the core that is first in this quantum never waits. With shorter quanta, both
/// cores wait about equally long.
TEST(ClusterBanks, TheBoardSetsTheLengthOfAQuantum) {
  const auto difference = [](std::uint32_t quantum) {
    const auto cycles = cycles_of(hammer(16), 2, with_quantum(quantum));
    EXPECT_NEAR(std::max(cycles[0], cycles[1]), 512, 8) << quantum;
    return std::max(cycles[0], cycles[1]) - std::min(cycles[0], cycles[1]);
  };
  EXPECT_LE(difference(1), 16U + 4U);
  EXPECT_LE(difference(16), 16U + 4U);
  EXPECT_GE(difference(1024), 240U);
}

TEST(ClusterCore, AddsTheLatencyOfL2) {
  const auto near = cycles_of("li a0, L1_BASE\n.rept 10\n lw a1, 0(a0)\n lw a2, 0(a0)\n.endr\n", 1)[0];
  const auto far = cycles_of("li a0, 0x1C070000\n.rept 10\n lw a1, 0(a0)\n lw a2, 0(a0)\n.endr\n", 1)[0];
  EXPECT_EQ(far, near + 20 * 14) << "14 cycles each: cluster router 2, AXI 12";
}

/// Returns the time [ns] of a job on two cores. The fabric controller forks `body` on both cores, and sleeps until they
/// are done. Registers for the body: a0 = argument, s2 = event unit, s3 = DMA, s1 = L1.
std::uint32_t job_ns(std::string_view body, std::uint32_t argument, std::uint32_t cluster_hz = 87'000'000) {
  Settings settings;
  settings.cluster_clock_hz = cluster_hz;
  BoardSystem system(BoardSystem::assembled(fmt::format(R"(
_start: li s0, POWER_MANAGER_BASE
    la a0, core
    sw a0, POWER_MANAGER_CLUSTER_BOOT_OFFSET(s0)
    li a0, 1
    sw a0, POWER_MANAGER_CLUSTER_POWER_OFFSET(s0)
    li s2, EVENT_UNIT_BASE
    li s4, TIMER_BASE
    li a0, 1000
1:  addi a0, a0, -1                 # the cores go to sleep meanwhile
    bnez a0, 1b
    la a0, job
    sw a0, EVENT_UNIT_FORK_ENTRY_OFFSET(s2)
    li a0, {}
    sw a0, EVENT_UNIT_FORK_ARGUMENT_OFFSET(s2)
    li a0, 1 << 17
    sw a0, EVENT_UNIT_EVENT_MASK_OFFSET(s2)
    lw s5, TIMER_TIME_LO_OFFSET(s4)
    li a0, 3
    sw a0, EVENT_UNIT_FORK_CORES_OFFSET(s2)
    .insn i 0x03, 6, a0, EVENT_UNIT_EVENT_WAIT_OFFSET(s2)
    lw s6, TIMER_TIME_LO_OFFSET(s4)
    sub s6, s6, s5
    li a1, 0x1C060000
    sw s6, 0(a1)
    sw a0, 4(a1)
2:  wfi
    j 2b
core: li s2, EVENT_UNIT_BASE
    li s3, CLUSTER_DMA_BASE
    li s1, L1_BASE
    csrr s0, mhartid
3:  .insn i 0x03, 6, t0, EVENT_UNIT_DISPATCH_WAIT_OFFSET(s2)
    lw a0, EVENT_UNIT_DISPATCH_ARGUMENT_OFFSET(s2)
    jalr t0
    sw zero, EVENT_UNIT_JOB_DONE_OFFSET(s2)
    j 3b
job:
{}
    ret
)",
                                                        argument, body)),
                     settings);
  system.soc.advance(10'000'000);
  EXPECT_EQ(system.result(1), 1U << 17) << "the event that woke the fabric controller";
  return system.result(0);
}

constexpr std::string_view kDelay = "1: addi a0, a0, -1\n bnez a0, 1b\n";

TEST(Fork, TakesAsLongAsItsCoresWork) {
  // An iteration of the delay takes 4 cycles: an addition, and a taken branch of 3. The fabric controller's cycle is 10
  // ns.
  const auto longer = job_ns(kDelay, 2000) - job_ns(kDelay, 1000);
  EXPECT_NEAR(longer, 4000 / kClusterHz * 1e9, 10 + 1);
}

TEST(Fork, TakesHalfTheTimeAtTwiceTheClock) {
  const auto longer = job_ns(kDelay, 2000, 174'000'000) - job_ns(kDelay, 1000, 174'000'000);
  EXPECT_NEAR(longer, 4000 / (2 * kClusterHz) * 1e9, 10 + 1);
}

TEST(Barrier, LetsTheFastWaitForTheSlow) {
  // Core 0 runs 1 iteration and waits. Core 1 runs `argument` iterations. After the barrier, each runs `argument`
  // iterations.
  constexpr std::string_view kMeet =
      "mv a1, a0\n bnez s0, 1f\n li a0, 1\n1: addi a0, a0, -1\n bnez a0, 1b\n"
      ".insn i 0x03, 6, a2, EVENT_UNIT_BARRIER_WAIT_OFFSET(s2)\n2: addi a1, a1, -1\n bnez a1, 2b\n";
  const auto longer = job_ns(kMeet, 2000) - job_ns(kMeet, 1000);
  EXPECT_NEAR(longer, 8000 / kClusterHz * 1e9, 10 + 1);
}

std::string copy(std::string_view size, std::string_view row) {
  return fmt::format(R"(
    bnez s0, 2f
    li a1, 0x1C040000
    sw a1, CLUSTER_DMA_L2_ADDRESS_OFFSET(s3)
    sw s1, CLUSTER_DMA_L1_ADDRESS_OFFSET(s3)
    li a1, {}
    sw a1, CLUSTER_DMA_SIZE_OFFSET(s3)
    li a1, {}
    sw a1, CLUSTER_DMA_ROW_OFFSET(s3)
    li a1, 512
    sw a1, CLUSTER_DMA_STRIDE_OFFSET(s3)
    li a1, 1 << 8
    sw a1, EVENT_UNIT_EVENT_MASK_OFFSET(s2)
    li a1, 1
    sw a1, CLUSTER_DMA_START_OFFSET(s3)
    .insn i 0x03, 6, a2, EVENT_UNIT_EVENT_WAIT_OFFSET(s2)
2:
)",
                     size, row);
}

TEST(Dma, MovesEightBytesACycle) {
  const auto longer = job_ns(copy("8192", "0"), 0) - job_ns(copy("4096", "0"), 0);
  EXPECT_NEAR(longer, 512 / kClusterHz * 1e9, 10 + 1);
}

TEST(Dma, TakesTwoCyclesForAShortRow) {
  // The copies differ by 64 rows of 4 bytes. A row is half of the 8 bytes per cycle that the DMA can transfer. But it
  // takes 2 cycles, because a burst has a latency of 16 cycles and only 8 bursts are in flight.
  const auto longer = job_ns(copy("512", "4"), 0) - job_ns(copy("256", "4"), 0);
  EXPECT_NEAR(longer, 128 / kClusterHz * 1e9, 10 + 1);
}

/// Busy cycles of core 1 and of the DMA. Core 1 loads 256 words from one bank, while core 0 waits for a copy of 16 KiB
/// into L1.
struct Rivals {
  std::uint32_t core_cycles = 0;
  std::uint64_t dma_cycles = 0;
};
Rivals core_beside_dma(bool copies) {
  const auto body = fmt::format(R"(
    li s3, CLUSTER_DMA_BASE
    li s2, EVENT_UNIT_BASE
    bnez s0, 3f
    li a1, 0x1C040000
    sw a1, CLUSTER_DMA_L2_ADDRESS_OFFSET(s3)
    sw s1, CLUSTER_DMA_L1_ADDRESS_OFFSET(s3)
    li a1, 16384
    sw a1, CLUSTER_DMA_SIZE_OFFSET(s3)
    li a1, 1 << 8
    sw a1, EVENT_UNIT_EVENT_MASK_OFFSET(s2)
    li a1, {}
    sw a1, CLUSTER_DMA_START_OFFSET(s3)
    .insn i 0x03, 6, a2, EVENT_UNIT_EVENT_WAIT_OFFSET(s2)
3:  li a0, 200
4:  addi a0, a0, -1
    bnez a0, 4b
    csrr s10, mcycle
    mv a0, s1
    {}
)",
                                copies ? 1 : 0, kHammer);
  auto system = cores_run(body, 2);
  system.soc.advance(1'000'000);
  return {system.result(1), system.soc.cluster()->dma().counts().busy_cycles};
}

TEST(Dma, TakesCyclesOfTheBanksFromTheCores) {
  // The DMA transfers two words per cycle, so it uses each of the 16 banks in every 8th cycle. A core that uses one
  // bank in every cycle conflicts with the DMA every 8 cycles. Then one of the two waits for a cycle.
  const auto alone = core_beside_dma(false);
  const auto beside = core_beside_dma(true);
  EXPECT_EQ(alone.core_cycles, 256U + 2U);
  EXPECT_EQ(alone.dma_cycles, 0U);
  const auto core_waited = beside.core_cycles - alone.core_cycles;
  const auto dma_waited = beside.dma_cycles - 16384 / 8;
  EXPECT_GT(core_waited, 0U);
  EXPECT_GT(dma_waited, 0U);
  EXPECT_NEAR(static_cast<double>(core_waited + dma_waited), 256.0 / 8, 4) << "a cycle shifts which words meet";
}

/// Each core waits in a loop for a store of the other core, and sees it one quantum later.
TEST(Cluster, SharesStoresOncePerQuantum) {
  constexpr std::uint32_t kTimes = 30;
  const auto body = fmt::format(R"(
    sw zero, 0(s1)
    li a2, {}
3:  lw a0, 0(s1)
    andi a1, a0, 1
    bne a1, s0, 3b
    addi a0, a0, 1
    sw a0, 0(s1)
    addi a2, a2, -1
    bnez a2, 3b
)",
                                kTimes);
  for (const std::uint32_t quantum : {32, 64, 256, 1024}) {
    const auto cycles = cycles_of(body, 2, with_quantum(quantum));
    EXPECT_NEAR(std::max(cycles[0], cycles[1]) / (2.0 * kTimes), quantum, 0.1 * quantum);
  }
}

/// Reads the order of the cluster's next quantum from its state: the first core, and whether the DMA is before the
/// cores.
class Order final : public state::Visitor {
 public:
  explicit Order(Soc& soc) : Visitor(Purpose::save) { soc.visit(*this); }
  std::pair<std::uint32_t, bool> of_next_quantum() const { return {core_, dma_}; }

 private:
  void fixed(std::string_view name, const state::Values& values) override {
    if (name == "first_core") std::memcpy(&core_, values.data, sizeof core_);
    if (name == "dma_first") std::memcpy(&dma_, values.data, sizeof dma_);
  }
  void changing(std::string_view /*name*/, state::List& /*list*/) override {}
  std::size_t count(std::string_view /*name*/, std::size_t present) override { return present; }

  std::uint32_t core_ = 0;
  bool dma_ = false;
};

std::size_t orders_of(unsigned cores, const BoardDescription& board) {
  auto system = cores_run(hammer(1000), cores, true, board);
  std::set<std::pair<std::uint32_t, bool>> seen;
  for (std::int64_t t = 10'000; t < 100'000; t += 300) {  // steps of half a quantum
    system.soc.advance(t);
    seen.insert(Order(system.soc).of_next_quantum());
  }
  return seen.size();
}

TEST(Dma, IsBeforeAndAfterEachFirstCoreOfATree) {
  const auto board = BoardSystem::without_caches();
  for (const unsigned cores : {2, 3, 8}) EXPECT_EQ(orders_of(cores, with_tree(board)), 2 * cores) << cores;
  EXPECT_EQ(orders_of(8, board), 8U) << "where orders rotate, flights are recorded with a side for each core";
}

TEST(Cluster, ConnectsL1OnlyWhileItIsOn) {
  BoardSystem system("_start: li a0, L1_BASE\n lw a1, 0(a0)\n");
  system.soc.advance(1'000'000);
  EXPECT_EQ(system.soc.end(), End::faulted);
  EXPECT_TRUE(system.soc.faulted());
  ASSERT_EQ(system.faults.size(), 1U);
  EXPECT_NE(system.faults[0].find("load access fault"), std::string::npos) << system.faults[0];
}

TEST(Cluster, ReportsTheFaultedCore) {
  auto system = cores_run("li a1, 2\n bne s0, a1, 1f\n .word 0\n1:\n", 4);
  system.soc.advance(1'000'000);
  EXPECT_EQ(system.soc.end(), End::faulted);
  EXPECT_TRUE(system.soc.faulted());
  ASSERT_EQ(system.faults.size(), 1U);
  EXPECT_NE(system.faults[0].find("cluster core 2: trap without a handler: illegal instruction"), std::string::npos)
      << system.faults[0];
}

TEST(Cluster, MoreCoresThanTheBoardHasAreRefused) {
  Settings settings;
  settings.cluster_cores = 9;
  EXPECT_THROW(BoardSystem("_start: j _start\n", settings), Error);
}

TEST(Cluster, DoesNotExistWithoutCores) {
  Settings settings;
  settings.cluster_cores = 0;
  BoardSystem system(R"(
_start: li s0, POWER_MANAGER_BASE
    li a0, 1
    sw a0, POWER_MANAGER_CLUSTER_POWER_OFFSET(s0)
    lw a1, POWER_MANAGER_STATUS_OFFSET(s0)
    li t0, 0x1C060000
    sw a1, 0(t0)
1:  wfi
    j 1b
)",
                     settings);
  system.soc.advance(1'000'000);
  EXPECT_EQ(system.soc.cluster(), nullptr);
  EXPECT_EQ(system.result(0), 1U) << "refused";
}

struct RuntimeOn {
  std::string_view board;
  std::string_view program;
};

class ClusterRuntimeOn : public testing::TestWithParam<RuntimeOn> {
 protected:
  static BoardSystem selftest() {
    return BoardSystem(Elf::read(fmt::format("{}/firmware/{}.elf", MEBOTS_BINARY_DIR, GetParam().program)), {},
                       read_board(fmt::format("{}/configs/boards/{}.json", MEBOTS_SOURCE_DIR, GetParam().board)));
  }
};

INSTANTIATE_TEST_SUITE_P(Boards, ClusterRuntimeOn,
                         testing::Values(RuntimeOn{"ai_deck", "cluster_selftest"},
                                         RuntimeOn{"gap8", "gap8_cluster_selftest"}),
                         [](const auto& each) { return std::string(each.param.board); });

constexpr std::int64_t kMiddle = 3'000'000;
constexpr std::int64_t kEnd = 20'000'000;

TEST_P(ClusterRuntimeOn, ForksSynchronisesCopiesAndRestarts) {
  auto system = selftest();
  system.soc.advance(kEnd);
  EXPECT_EQ(system.soc.end(), End::exited);
  EXPECT_EQ(system.soc.exit_code(), 0);
  EXPECT_EQ(system.console, std::vector<std::string>{"cluster: all right"});
  EXPECT_TRUE(system.faults.empty());
}

TEST_P(ClusterRuntimeOn, GivesTheSameBitsForAllSteps) {
  auto whole = selftest();
  whole.soc.advance(kEnd);
  for (const std::int64_t step : {std::int64_t{777}, std::int64_t{10'000}, std::int64_t{1'999'999}}) {
    auto split = selftest();
    for (std::int64_t t = step; t < kEnd; t += step) split.soc.advance(t);
    split.soc.advance(kEnd);
    EXPECT_TRUE(mebots::test::same_state(split.soc, whole.soc)) << step;
    EXPECT_EQ(split.soc.energy().total_j(), whole.soc.energy().total_j());
  }
}

TEST_P(ClusterRuntimeOn, ContinuesWithTheSameBitsFromAStateDuringAJob) {
  auto straight = selftest();
  straight.soc.advance(kMiddle);
  ASSERT_TRUE(straight.soc.cluster()->powered());
  const auto middle = state::save(straight.soc);
  straight.soc.advance(kEnd);
  auto other = selftest();
  other.soc.advance(kMiddle / 3);
  state::restore(other.soc, middle);
  other.soc.advance(kEnd);
  EXPECT_TRUE(mebots::test::same_state(other.soc, straight.soc));
}

/// A program for eight cores that use one bank. The boundaries of its blocks differ between runs: a block
/// may begin in the middle of straight code, at the target of a jump, or after the return from a trap, and may contain
/// the end of a former hardware loop.
constexpr std::string_view kMixed = R"(
    mv a0, s1
    la s2, late
    la s3, mark
    la s4, handler
    csrw mtvec, s4
    csrwi 0x7B2, 1
    csrw 0x7B1, s3                  # a hardware loop ends at mark ...
    csrwi 0x7B1, 0                  # ... and does not any more
    addi s4, s0, 3
again: addi s4, s4, 13
    andi s5, s4, 7
    lw a1, 0(a0)
    beqz s5, early
    addi s6, s5, -1
    beqz s6, late
    addi s6, s5, -2
    beqz s6, mark
    .rept 20
    lw a1, 0(a0)
    add a2, a2, a1
    .endr
early: addi a2, a2, 1
    ecall
mark: lw a3, 0(a0)
    .rept 9
    sw a2, 0(a0)
    .endr
late: lw a4, 64(a0)
    bltz a2, early
    addi a2, a2, 3
    j 5f
5:  lw a4, 64(a0)
    beqz s6, 6f
6:  j 7f
    nop
7:  andi s7, s4, 24
    beqz s7, again
    jal ra, 8f
    j again
8:  lw a4, 128(a0)
    ret
    .balign 4
handler: csrr a5, mepc
    addi a5, a5, 4
    csrw mepc, a5
    mret
)";

/// Compares a run of `cores` on `board` with an interpreted run, and with runs that continue from its saved states. All
/// runs must have the same bits.
void expect_same_turns(unsigned cores, const BoardDescription& board) {
  auto straight = cores_run(kMixed, cores, true, board);
  auto interpreted = cores_run(kMixed, cores, false, board);
  for (std::int64_t t = 24'003; t < 1'000'000; t += 24'003) {
    const auto saved = state::save(straight.soc);
    straight.soc.advance(t);
    interpreted.soc.advance(t);
    auto other = cores_run(kMixed, cores, true, board);
    state::restore(other.soc, saved);
    other.soc.advance(t);
    ASSERT_TRUE(mebots::test::same_state(other.soc, straight.soc)) << cores << " cores, restored, up to " << t << " ns";
    ASSERT_TRUE(mebots::test::same_state(interpreted.soc, straight.soc)) << cores << " cores, up to " << t << " ns";
  }
  EXPECT_TRUE(straight.faults.empty());
  EXPECT_GT(straight.soc.cluster()->counters().instructions, 10'000U * cores);
}

TEST(ClusterRuntime, HasTheSameOrderWithAndWithoutDecodedCode) {
  expect_same_turns(8, BoardSystem::without_caches());
  for (const unsigned cores : {2, 3, 8}) expect_same_turns(cores, with_tree(BoardSystem::without_caches()));
}

/// Saves the state repeatedly while the network runs on 1, 2, 4 and 8 cores, mostly in the middle of a layer. Another
/// system, which has translated other code, continues from each state. Its bits must equal those of the uninterrupted
/// run.
TEST(ClusterRuntime, ContinuesWithTheSameBitsFromStatesDuringAnInference) {
  const auto program = Elf::read(MEBOTS_BINARY_DIR "/firmware/network_bench.elf");
  BoardSystem straight(program);
  constexpr std::int64_t kStep = 1'937'003;
  straight.soc.advance(kStep);
  for (std::int64_t t = 2 * kStep; t < 400'000'000; t += kStep) {
    const auto saved = state::save(straight.soc);
    straight.soc.advance(t);
    BoardSystem other(program);
    state::restore(other.soc, saved);
    other.soc.advance(t);
    ASSERT_TRUE(mebots::test::same_state(other.soc, straight.soc)) << "from " << t - kStep << " to " << t << " ns";
    ASSERT_EQ(other.soc.energy().total_j(), straight.soc.energy().total_j());
  }
}

/// Eight cores run a loop. In every 997th iteration, core 0 exchanges an instruction of the loop.
constexpr std::string_view kPatching = R"(
    la s2, patched
    lw s3, 0(s2)
    la s4, other
    lw s4, 0(s4)
    mv a0, s1
    mv s5, s0                       # core 0 begins
    li s6, 997
again: addi s5, s5, 1
    lw a1, 0(a0)
    add a2, a2, a1
    .balign 4
    .option push
    .option norvc
patched: addi a3, a3, 1
    .option pop
    remu s7, s5, s6
    bnez s7, again
    bnez s0, again
    xor s8, s3, s4
    lw s9, 0(s2)
    xor s9, s9, s8
    sw s9, 0(s2)
    fence.i
    j again
    .balign 4
    .option norvc
other: addi a3, a3, 3
    .option rvc
)";

TEST(ClusterRuntime, TranslatedCoresFollowStoresIntoCode) {
  auto translated = cores_run(kPatching, 8);
  auto interpreted = cores_run(kPatching, 8, false);
  expect_same_bits(translated.soc, interpreted.soc, 99'991, 3'000'000);
  const auto& core = translated.soc.cluster()->hart(5);
  EXPECT_EQ(core.code().is_translated(), translate::can_translate());
  EXPECT_FALSE(interpreted.soc.cluster()->hart(5).code().is_translated());
  EXPECT_GT(core.reg(13), core.reg(21) + 1000U) << "a3 grows by 1 and 3 in turns, s5 always by 1";
  EXPECT_TRUE(translated.faults.empty());
}

/// Blocks of divisions and of loads from L2 run for thousands of ticks past the end of a quantum. Meanwhile, other
/// cores use the banks.
TEST(ClusterRuntime, TranslatedCoresWaitAsInterpretedInTheLongestBlocks) {
  std::string body = "mv a0, s1\nli a1, 0x1C050000\nli a2, 0x7fffffff\nadd a3, s0, s0\nadd a3, a3, s1\nagain:\n";
  for (int i = 0; i < 60; ++i) body += "divu a4, a2, s0\n";
  body += "sw a4, 0(a0)\nlw a5, 2(a0)\nj 3f\n3:\n";
  for (int i = 0; i < 60; ++i) body += i % 4 == 3 ? "lw a4, 0(a0)\n" : "lw a4, 4(a1)\n";
  body += "lh a5, 1(a3)\nj again\n";
  auto translated = cores_run(body, 8);
  auto interpreted = cores_run(body, 8, false);
  expect_same_bits(translated.soc, interpreted.soc, 99'991, 10'000'000);
  EXPECT_EQ(translated.soc.cluster()->hart(0).code().is_translated(), translate::can_translate());
}

class Watcher final : public Observer {
 public:
  explicit Watcher(Soc& soc) {
    for (unsigned number = 0; number < soc.harts(); ++number) soc.observe(number, this);
  }
  void retired(const Hart& /*hart*/, const Retired& /*instruction*/) override { ++retired_; }
  std::uint64_t count() const { return retired_; }

 private:
  std::uint64_t retired_ = 0;
};

/// Both systems run the same program up to `end_ns`, and must have the same bits; only `watched` is observed.
void expect_same_bits_watched(Soc& plain, Soc& watched, std::int64_t step_ns, std::int64_t end_ns) {
  const auto unseen = watched.instructions();
  const Watcher watcher(watched);
  expect_same_bits(plain, watched, step_ns, end_ns);
  EXPECT_EQ(watcher.count(), watched.instructions() - unseen);
  for (unsigned number = 0; number < watched.harts(); ++number) watched.observe(number, nullptr);
}

TEST(ClusterRuntime, KeepsItsBitsWithAnObserver) {
  auto plain = cores_run(kMixed, 8);
  auto watched = cores_run(kMixed, 8);
  expect_same_bits_watched(plain.soc, watched.soc, 9'973, 400'000);
  EXPECT_GT(watched.soc.cluster()->counters().instructions, 40'000U);
}

/// Observes the network from the last inferences on four cores until it runs on eight cores.
TEST(ClusterRuntime, KeepsItsBitsWithAnObserverDuringAnInference) {
  const auto program = Elf::read(MEBOTS_BINARY_DIR "/firmware/network_bench.elf");
  BoardSystem plain(program);
  BoardSystem watched(program);
  for (auto* system : {&plain, &watched}) system->soc.advance(332 * kMs);
  const auto& first = watched.soc.hart(1).counters();
  const auto& last = watched.soc.hart(8).counters();
  const auto on_four = first.instructions;
  ASSERT_LT(last.instructions, 1'000U) << "it has only been switched on and off";
  expect_same_bits_watched(plain.soc, watched.soc, 371'003, 342 * kMs);
  EXPECT_GT(last.instructions, 100'000U);
  EXPECT_GT(first.instructions - on_four, last.instructions + 100'000U) << "some of them on four cores";
}

/// Runs the network on 1, 2, 4 and 8 cores, with bank conflicts, instruction caches, barriers and DMA.
TEST(ClusterRuntime, TranslatedCoresKeepTheInterpretersBits) {
  const auto program = Elf::read(MEBOTS_BINARY_DIR "/firmware/network_bench.elf");
  Settings settings;
  BoardSystem translated(program, settings);
  settings.translate = false;
  BoardSystem interpreted(program, settings);
  expect_same_bits(translated.soc, interpreted.soc, 17'777'777, 400'000'000);
  EXPECT_GT(translated.soc.cluster()->counters().instructions, 40'000'000U);
  EXPECT_EQ(translated.soc.cluster()->hart(0).code().is_translated(), translate::can_translate());
}

/// Returns code that loops for 40,000 cycles of a core, and then executes `end`.
std::string works_and(std::string_view end) {
  return fmt::format("li t0, 10000\n3: addi t0, t0, -1\nbnez t0, 3b\n{}\n", end);
}
constexpr auto kWork = static_cast<Picoseconds>(39'998 / kClusterHz * kPsPerS);
constexpr Picoseconds kStart = 10'000 * kPsPerNs;  // more time than the controller needs to switch the cluster on

TEST(ClusterAlone, RunLastsUntilTheClusterEndsWhileTheControllerSleeps) {
  struct Case {
    std::string_view how;
    std::string_view end;
    End why;
  };
  for (const auto& [how, end, why] :
       {Case{"stored tohost",
             "la t0, tohost\nli t1, 1\nsw t1, 0(t0)\n.pushsection .tohost, \"aw\"\n.balign 64\n"
             ".globl tohost\ntohost: .word 0, 0\n.popsection",
             End::host},
        Case{"faulted", "li t0, 0x30000000\nlw t0, 0(t0)", End::faulted}, Case{"fell asleep", "", End::none}}) {
    auto system = cores_run(works_and(end), 1);
    auto& soc = system.soc;
    if (const auto tohost = soc.program().symbol("tohost")) soc.program_host().watch(*tohost);
    soc.run_cycles(1'000'000);
    EXPECT_EQ(soc.end(), why) << how;
    EXPECT_GT(soc.now(), kWork) << how;
    EXPECT_LT(soc.now(), kWork + kStart) << how;
    EXPECT_GT(soc.sleep_time(), kWork - kStart) << how << ": the controller slept meanwhile";
  }
}

/// Both cores execute an illegal instruction, one of them up to a quantum after the other.
TEST(ClusterAlone, RunEndsWithTheCoreThatStopsFirst) {
  unsigned both = 0;
  for (unsigned later = 0; later < 2; ++later) {
    for (unsigned by = 0; by < 12; by += 3) {
      auto system = cores_run(fmt::format(R"(
    li t0, 20
    li t1, {}
    bne s0, t1, 3f
    addi t0, t0, {}
3:  addi t0, t0, -1
    bnez t0, 3b
    unimp)",
                                          later, by),
                              2);
      auto& soc = system.soc;
      soc.run_cycles(1'000'000);
      ASSERT_EQ(soc.end(), End::faulted);
      const auto reported = static_cast<unsigned>(soc.cluster()->faulted_core());
      EXPECT_EQ(soc.now(), soc.core_time(1 + reported)) << by;
      const auto& other = soc.hart(2 - reported);
      if (!other.fault().happened) continue;
      ++both;
      EXPECT_LE(soc.now(), soc.core_time(2 - reported)) << "core " << later << " is later by " << by;
    }
  }
  EXPECT_GT(both, 4U) << "in one quantum";
}

TEST(ClusterAlone, RunLastsUntilTheClusterReachesTheLimitOfCycles) {
  auto system = cores_run(works_and(""), 1);
  system.soc.run_cycles(20'000);
  EXPECT_GE(system.soc.now(), static_cast<Picoseconds>(20'000 / kClusterHz * kPsPerS));
}

}  // namespace
}  // namespace mebots::soc::test
