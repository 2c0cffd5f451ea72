// SPDX-License-Identifier: Apache-2.0
// Tests GAP8's memories: latency of L2, banks of L1, test-and-set.
#include "gap8_system.hpp"
#include "support/same_state.hpp"

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

struct Factors {
  std::uint32_t soc;
  std::uint32_t cluster;
};

/// Returns a program that switches the cluster on. Each core whose bit is set in `who` loads 256 words of L2, and
/// sleeps.
std::string cores_that_load_from_l2(std::uint32_t who, const Factors& factors) {
  const auto clocks = fmt::format(R"(
    li s0, FLL_BASE
    li a0, 1 << 26 | {}
    sw a0, FLL_CONFIG1_OFFSET(s0)
    li a0, 1 << 26 | {}
    sw a0, FLL_BYTES + FLL_CONFIG1_OFFSET(s0)
)",
                                  factors.soc, factors.cluster);
  constexpr std::string_view kLoad = R"(
    li s1, L2_BASE + 0x40000
    li a2, 256
2:  lw a0, 0(s1)
    addi a2, a2, -1
    bnez a2, 2b
3:  wfi
    j 3b
core: li s1, L2_BASE + 0x40000
    li a2, 256
4:  lw a0, 0(s1)
    addi a2, a2, -1
    bnez a2, 4b
    li s0, EU_BASE
5:  .insn i 0x03, 6, a5, EU_WAIT_CLEAR_OFFSET(s0)
    j 5b
fault: j fault
)";
  return fmt::format("{}{}{}{}", kBegin, clocks, start_cluster(who), kLoad);
}

std::uint64_t cycles_of_core(std::uint32_t who, const Factors& factors, unsigned core,
                             const BoardDescription& board = Gap8System::gap8()) {
  Gap8System system(cores_that_load_from_l2(who, factors), {}, board);
  system.soc.advance(20 * kMs);
  EXPECT_TRUE(system.faults.empty()) << system.faults.front();
  EXPECT_TRUE(system.soc.hart(1 + core).sleeping());
  return system.soc.hart(1 + core).counters().cycles;
}

/// kLoopCycles are the cycles of an addition, a taken branch, and a load without its latency.
constexpr std::uint64_t kLoads = 256;
constexpr std::uint64_t kLoopCycles = 5;

TEST(Gap8Cluster, CountsTheLatencyOfL2InTheClocksOfClusterAndSoc) {
  // Tolerance for the cycles of the program's start and end and for cache refills. `way` is the latency of a load and
  // of a refill.
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
  // An access occupies the cluster's port to L2 for one cycle of the SoC, which is 8 cycles of the cluster. The latency
  // is so long that the accesses of eight cores overlap.
  const Factors factors{600, 4800};
  EXPECT_LT(cycles_of_core(0xff, factors, 7), cycles_of_core(1, factors, 0) * 5 / 4);
  auto board = Gap8System::gap8();
  for (auto& memory : board.memories) {
    if (memory.latency) memory.latency->soc = 1;
  }
  EXPECT_LT(cycles_of_core(1, factors, 0, board), kLoads * 24);
  EXPECT_GE(cycles_of_core(0xff, factors, 7, board), kLoads * 8 * 8 * 9 / 10) << "eight loads take 64 cycles";
}

/// Even cores load from L2 and store to L1, to which odd cores also store. With a slow clock of the SoC, the loads of
/// one block may take more cycles than the table of L1's banks has rows.
TEST(Gap8Cluster, TranslatedCodeSupportsAnyWaitForL2) {
  struct Mix {
    unsigned far;
    unsigned near;
  };
  const auto program = [](std::uint32_t who, const Factors& factors, const Mix& mix) {
    return fmt::format(R"({}
    li s0, FLL_BASE
    li a0, 1 << 26 | {}
    sw a0, FLL_CONFIG1_OFFSET(s0)
    li a0, 1 << 26 | {}
    sw a0, FLL_BYTES + FLL_CONFIG1_OFFSET(s0)
    {}
3:  wfi
    j 3b
core: csrr s2, mhartid
    andi s2, s2, 15
    li s1, L2_BASE + 0x40000
    li s0, L1_BASE
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
        const auto elf = Gap8System::assembled(program(who, factors, mix));
        Gap8System system(elf);
        Settings without_translation;
        without_translation.translate = false;
        Gap8System interpreted(elf, without_translation);
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
  const auto cycles_from = [](std::string_view address) {
    Gap8System system(fmt::format(R"(
_start: li s1, {}
    li a2, 256
1:  lw a0, 0(s1)
    addi a2, a2, -1
    bnez a2, 1b
2:  wfi
    j 2b
)",
                                  address));
    system.soc.advance(1 * kMs);
    return system.soc.hart().counters().cycles;
  };
  EXPECT_EQ(cycles_from("L2_BASE + 0x40000") - cycles_from("FC_TCDM_BASE"), kLoads * 8);
}

/// Each core adds 1 to a word of L1, 20 times, while it holds a lock (test-and-set). The last core prints characters by
/// storing them to the address for output.
constexpr std::string_view kLocks = R"(
2:  wfi
    j 2b
core: li s0, EU_BASE
    li s1, L1_BASE + 0x100      # the lock
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
    li a6, RESULTS
    sw a4, 0(a6)
    lw a3, 0(s2)
    sw a3, 4(a6)
    li s2, 0x10100100      # the long way
    lw a3, 0(s2)
    sw a3, 8(a6)
    li a6, CHARACTER_OUTPUT_BASE
    li a5, 'o'
    sb a5, 0(a6)
    li a5, 'k'
    sh a5, 4(a6)
    li a5, 10
    sb a5, 1(a6)
4:  .insn i 0x03, 6, a5, EU_WAIT_CLEAR_OFFSET(s0)
    j 4b
fault: j fault
)";

TEST(Gap8Cluster, LocksByTestAndSetAndStoresBytesIntoDevicesOfTheSoc) {
  Gap8System system(fmt::format("{}{}{}", kBegin, start_cluster(0xff), kLocks));
  system.soc.advance(5 * kMs);
  EXPECT_TRUE(system.faults.empty()) << system.faults.front();
  EXPECT_EQ(system.result(0), 160U);
  EXPECT_EQ(system.result(1), 0U) << "it was free";
  EXPECT_EQ(system.result(2), 0xffffffffU) << "taken by the load before";
  EXPECT_EQ(system.console, std::vector<std::string>{"ok"});
}

/// Eight cores load one word of L1, at `address`, 256 times each. Returns the cycles of the slowest core.
std::uint64_t cycles_of_one_bank(std::string_view address) {
  const auto loads = fmt::format(R"(
    .option norvc          # the code is as long with either address
2:  wfi
    j 2b
core: li s0, EU_BASE
    li s1, {}
    li a2, 256
3:  lw a0, 0(s1)
    addi a2, a2, -1
    bnez a2, 3b
4:  .insn i 0x03, 6, a5, EU_WAIT_CLEAR_OFFSET(s0)
    j 4b
fault: j fault
)",
                                 address);
  Gap8System system(fmt::format("{}{}{}", kBegin, start_cluster(0xff), loads));
  system.soc.advance(5 * kMs);
  EXPECT_TRUE(system.faults.empty()) << system.faults.front();
  std::uint64_t longest = 0;
  for (unsigned core = 1; core <= 8; ++core) longest = std::max(longest, system.soc.hart(core).counters().cycles);
  return longest;
}

TEST(Gap8Cluster, WaitsForABankOfL1AlsoAtItsAlias) {
  constexpr std::uint64_t kOneWordACycle = 8U * 256;
  // Each core reaches the end of a quantum at a different instruction, so the order at the bank differs.
  constexpr std::uint64_t kMost = kOneWordACycle * 11 / 10;
  for (const auto* address : {"L1_BASE + 0x1100", "0x1100"}) {
    const auto cycles = cycles_of_one_bank(address);
    EXPECT_GE(cycles, kOneWordACycle) << address;
    EXPECT_LE(cycles, kMost) << address;
  }
}

}  // namespace
}  // namespace mebots::soc::test
