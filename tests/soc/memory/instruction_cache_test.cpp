// SPDX-License-Identifier: Apache-2.0
#include "board_system.hpp"
#include "machine.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace mebots::soc::test {
namespace {

/// A cache with 64 sets of 4 ways and lines of 16 bytes, as in GAP8.
constexpr InstructionCacheSettings kGap8{4096, 16, 4, 9};

TEST(InstructionCache, MissesOnceAndThenHits) {
  InstructionCache cache(kGap8);
  EXPECT_EQ(cache.fetch(cache.line_of(0x1C000010), 100), 9U);
  EXPECT_EQ(cache.fetch(cache.line_of(0x1C00001E), 109), 0U);
  EXPECT_EQ(cache.refills(), 1U);
}

TEST(InstructionCache, ACoreWaitsForALineThatAnotherCoreFetches) {
  InstructionCache cache(kGap8, InstructionCache::Users::several);
  cache.fetch(5, 100);
  EXPECT_EQ(cache.fetch(5, 103), 6U);
  EXPECT_EQ(cache.fetch(5, 50), 9U) << "an earlier core waits no longer than for a refill of its own";
  EXPECT_EQ(cache.refills(), 1U);
}

TEST(InstructionCache, ALineHasArrivedForAllWhenAllCoresArePastItsArrival) {
  Memory memory;
  memory.add("ram", 0, 4096);
  InstructionCache cache(kGap8, InstructionCache::Users::several);
  cache.cover(memory);
  cache.fetch(5, 100);
  cache.fetch(6, 104);
  const auto arrived = [&cache](std::uint32_t line) {
    EXPECT_EQ(cache.has_arrived(line), *cache.presence(cache.address_of(line)) != 0);
    return cache.has_arrived(line);
  };
  cache.settle(108);
  EXPECT_FALSE(arrived(5));
  cache.settle(109);
  EXPECT_TRUE(arrived(5));
  EXPECT_FALSE(arrived(6));
  EXPECT_TRUE(cache.holds(6));
  // While only one core uses the cache, each line that it has fetched counts as arrived, because the core waits for it.
  // When a second core starts, line 7 has not arrived.
  cache.settle(200);
  cache.set_alone(true);
  cache.fetch(7, 200);
  EXPECT_TRUE(arrived(7));
  cache.set_alone(false);
  EXPECT_FALSE(arrived(7));
  EXPECT_TRUE(arrived(5));
  cache.settle(209);
  EXPECT_TRUE(arrived(7));
  cache.flush();
  EXPECT_FALSE(arrived(5) || arrived(6) || arrived(7));
}

TEST(InstructionCache, TheOnlyUserHasWaitedForEachPresentLine) {
  InstructionCache cache(kGap8);
  EXPECT_FALSE(cache.is_shared());
  EXPECT_EQ(cache.fetch(5, 100), 9U);
  EXPECT_EQ(cache.fetch(5, 109), 0U);
  EXPECT_EQ(cache.fetch(5, 0), 0U) << "a core that was reset counts from 0 again";
  EXPECT_EQ(cache.refills(), 1U);
}

TEST(InstructionCache, TheShiftRegisterSelectsTheWayOfARefill) {
  // The register has 8 bits and is shifted to the left. The new bit 0 is set if an even number of bits 7, 3, 2 and 1 is
  // set. From 0 the values are 1, 3, 6, 0xd, 0x1b. Bits 2 and 1 select the way: 0, 1, 3, 2, 1. So the fifth line
  // replaces the second.
  InstructionCache cache({64, 16, 4, 9});
  for (std::uint32_t line = 1; line <= 4; ++line) {
    cache.fetch(line, 0);
    EXPECT_TRUE(cache.holds(1));
  }
  cache.fetch(5, 0);
  EXPECT_FALSE(cache.holds(2));
  EXPECT_TRUE(cache.holds(1) && cache.holds(3) && cache.holds(4) && cache.holds(5));
}

TEST(InstructionCache, PrefersInvalidWaysIfTheBoardRequestsIt) {
  InstructionCache cache({64, 16, 4, 9, 0, true}, InstructionCache::Users::several);
  for (std::uint32_t line = 1; line <= 4; ++line) cache.fetch(line, 0);
  for (std::uint32_t line = 1; line <= 4; ++line) EXPECT_TRUE(cache.holds(line)) << line;
  EXPECT_EQ(cache.shift_register(), 0U) << "no refill yet";
  cache.fetch(5, 0);  // bits 2 and 1 of the shift register's value 1 select way 0
  EXPECT_FALSE(cache.holds(1));
  EXPECT_TRUE(cache.holds(5));
  cache.flush();
  for (std::uint32_t line = 11; line <= 14; ++line) cache.fetch(line, 0);
  for (std::uint32_t line = 11; line <= 14; ++line) EXPECT_TRUE(cache.holds(line)) << line;
}

TEST(InstructionCache, HasTheLinesOfAdjacentMemoriesInTheOrderOfAddresses) {
  // Code continues in the next memory, and translated code reads the bytes of all its lines together.
  Memory memory;
  memory.add("second", 0x1000, 64);
  memory.add("other", 0x8000, 64);
  memory.add("first", 0xf80, 128);
  InstructionCache cache(kGap8);
  cache.cover(memory);
  const auto last = cache.line_of(0xff0);
  EXPECT_EQ(cache.number_of(last + 1), cache.number_of(last) + 1);
  EXPECT_EQ(cache.presence(0x1000), cache.presence(0xff0) + 1);
}

TEST(InstructionCache, IsEmptyAfterAFlush) {
  InstructionCache cache(kGap8);
  for (std::uint32_t line = 0; line < 256; ++line) cache.fetch(line, 0);
  cache.flush();
  for (std::uint32_t line = 0; line < 256; ++line) EXPECT_FALSE(cache.holds(line));
}

/// Returns straight code of 64 instructions of 4 bytes, which are 16 lines. It is executed `turns` times.
std::string straight_code(int turns, std::string_view end_of_turn = "") {
  return fmt::format(R"(
    .option norvc
_start: li s0, {}
    j 1f
    .balign 16
1:  .rept 60
    addi a0, a0, 1
    .endr
    {}
    addi s0, s0, -1
    nop
    bnez s0, 1b
    nop
)",
                     turns, end_of_turn) +
         std::string(kEnd);
}

Counters counters_of(const Elf& program, std::uint64_t* refills, bool translated = true) {
  Machine machine(program, {.instruction_cache = kGap8, .translate = translated});
  EXPECT_EQ(machine.run(), Stop::watch);
  *refills = machine.instruction_cache()->refills();
  return machine.hart().counters();
}

TEST(Fetch, CostsARefillForEveryLineTheFirstTime) {
  for (const int turns : {1, 2, 1000}) {
    const auto program = assemble(straight_code(turns));
    Machine free_of_waits(program);
    free_of_waits.run();
    std::uint64_t refills = 0;
    const auto counters = counters_of(program, &refills);
    // li and j are in one line of the cache. The loop with its nop is in 16 lines, and the 4 words of the end are in
    // one line.
    EXPECT_EQ(refills, 1U + 16U + 1U);
    EXPECT_EQ(counters.fetch_cycles, 9 * refills);
    EXPECT_EQ(counters.cycles, free_of_waits.hart().counters().cycles + counters.fetch_cycles);
    EXPECT_EQ(counters.instructions, free_of_waits.hart().counters().instructions);
  }
}

TEST(Fetch, FenceOfInstructionsEmptiesTheCache) {
  std::uint64_t without = 0;
  std::uint64_t with = 0;
  counters_of(assemble(straight_code(10, "nop")), &without);
  counters_of(assemble(straight_code(10, "fence.i")), &with);
  // Every iteration fetches its 16 lines again. The line that contains the fence is fetched before and after the fence.
  EXPECT_EQ(with, without + 10 * 1 + 9 * 15);
}

TEST(Fetch, MissesInEveryIterationOfALoopThatDoesNotFit) {
  // The loop has 8 KiB, and the cache 4 KiB.
  const auto program = assemble(R"(
    .option norvc
_start: li s0, 50
1:  .rept 2044
    addi a0, a0, 1
    .endr
    addi s0, s0, -1
    beqz s0, 2f
    j 1b
2:
)" + std::string(kEnd));
  std::uint64_t refills = 0;
  std::uint64_t interpreted = 0;
  EXPECT_EQ(counters_of(program, &refills).cycles, counters_of(program, &interpreted, false).cycles);
  EXPECT_EQ(refills, interpreted);
  EXPECT_GT(refills, 50U * 512U / 2) << "twice as much code as room: at least half of it is never there";
  EXPECT_LT(refills, 50U * 513U);
}

constexpr std::string_view kWanderer = R"(
_start: li s0, 30
    la s1, data
1:  andi t0, s0, 3
    beqz t0, 2f
    lw a0, 2(s1)
    jal ra, far_away
    .rept 9
    c.addi a0, 1
    .endr
    addi a1, a0, 1000
    sw a1, 4(s1)
2:  addi s0, s0, -1
    mulh a2, a1, s0
    jal ra, near
    bnez s0, 1b
    j 3f
near: div a3, a1, s0
    ret
    .space 4000
far_away: lw a4, 0(s1)
    add a4, a4, a0
    ret
3:
)";

TEST(Fetch, HasTheSameRefillsInTheSameCyclesForAllLimits) {
  const auto program = assemble(std::string(kWanderer) + std::string(kEnd) + ".data\n.balign 64\ndata: .zero 64\n");
  for (const std::uint32_t bytes : {64U, 256U, 4096U}) {
    const MachineSettings settings{.instruction_cache = {bytes, 16, 2, 9}};
    Machine whole(program, settings);
    EXPECT_EQ(whole.run(), Stop::watch);
    Machine cut(program, settings);
    for (std::uint64_t limit = 1; cut.run(limit) == Stop::limit; ++limit) {
    }
    EXPECT_EQ(cut.hart().counters().cycles, whole.hart().counters().cycles) << bytes;
    EXPECT_EQ(cut.hart().counters().fetch_cycles, whole.hart().counters().fetch_cycles) << bytes;
    EXPECT_EQ(cut.instruction_cache()->refills(), whole.instruction_cache()->refills()) << bytes;
    EXPECT_EQ(cut.word("data", 1), whole.word("data", 1));
  }
}

TEST(Fetch, CoresOfAClusterFetchSharedCodeOnce) {
  // All eight cores run the same cold code at the same time: one fetches a line, the others wait for its arrival.
  constexpr std::string_view kText = R"(
_start: li s0, POWER_MANAGER_BASE
    la a0, core
    sw a0, POWER_MANAGER_CLUSTER_BOOT_OFFSET(s0)
    li a0, 1
    sw a0, POWER_MANAGER_CLUSTER_POWER_OFFSET(s0)
1:  wfi
    j 1b
    .balign 16
core: .rept 400
    addi a0, a0, 1000
    .endr
    csrr a1, mcycle
2:  wfi
    j 2b
)";
  BoardSystem system(kText);
  system.soc.advance(1'000'000);
  const auto& cluster = *system.soc.cluster();
  ASSERT_NE(cluster.instruction_cache(), nullptr);
  const auto refills = cluster.instruction_cache()->refills();
  EXPECT_EQ(refills, 101U) << "400 words, and the word after them";
  for (unsigned core = 0; core < cluster.cores(); ++core) {
    const auto& counters = cluster.hart(core).counters();
    // One core fetches each line, and the others wait for the same refill. No core waits longer than for one refill of
    // each line.
    EXPECT_GT(counters.fetch_cycles, 101U * 20U / 2) << core;
    EXPECT_LE(counters.fetch_cycles, 101U * 20U) << core;
  }
}

TEST(Fetch, RefillsAreAccessesToL2) {
  // 200 iterations of 16 lines: with a flush in each, the refills are the only additional accesses to L2.
  const auto l2_energy = [](std::string_view end_of_turn) {
    BoardSystem system(fmt::format(R"(
    .option norvc
_start: li s0, 200
1:  .rept 60
    addi a0, a0, 1
    .endr
    {}
    addi s0, s0, -1
    bnez s0, 1b
2:  wfi
    j 2b
)",
                                   end_of_turn));
    system.soc.advance(1'000'000);
    return std::pair(system.soc.energy()[Part::l2], system.soc.instruction_cache()->refills());
  };
  const auto [warm_j, warm] = l2_energy("nop");
  const auto [cold_j, cold] = l2_energy("fence.i");
  EXPECT_GT(cold, warm + 3000);
  const auto word_j = gap8().energy.memory_access.at({25, 1.2, 100e6});
  // The difference of two energies loses digits, so the tolerance is relative to the larger energy.
  EXPECT_NEAR(cold_j - warm_j, static_cast<double>(cold - warm) * 4 * word_j, 1e-9 * cold_j);
}

}  // namespace
}  // namespace mebots::soc::test
