// SPDX-License-Identifier: Apache-2.0
#include "machine.hpp"
#include "support/same_state.hpp"

#include <gtest/gtest.h>

namespace mebots::soc::test {
namespace {

TEST(Banks, DelayTheSecondClaimByACycle) {
  Banks banks(16);
  EXPECT_EQ(banks.claim(5, 0x10000000), 0U);
  EXPECT_EQ(banks.claim(5, 0x10000040), 1U);  // an address 16 words later is in the same bank
  EXPECT_EQ(banks.claim(5, 0x10000004), 0U);
  EXPECT_EQ(banks.claim(6, 0x10000000), 1U);  // the access that waited has claimed cycle 6
}

TEST(Banks, KeepClaimsWhenTheWindowMoves) {
  Banks banks(16);
  for (std::uint64_t tick = 0; tick < 100; ++tick) EXPECT_EQ(banks.claim(tick, 0), 0U);
  banks.move_to(40);
  EXPECT_EQ(banks.claim(40, 0), 60U);
  EXPECT_EQ(banks.claim(60, 0), 41U);
  banks.move_to(104);
  EXPECT_EQ(banks.claim(104, 0), 0U);
}

TEST(Banks, ServeALongQueueOneByOne) {
  Banks banks(16);
  banks.move_to(1000);
  for (std::uint64_t turn = 0; turn < 700; ++turn) EXPECT_EQ(banks.claim(1000, 0), turn);
  banks.move_to(1200);
  EXPECT_EQ(banks.claim(1200, 0), 500U);
  EXPECT_EQ(banks.claim(1200, 4), 0U);
}

TEST(Banks, KeepClaimsWhenTheTableStartsOver) {
  Banks banks(16);
  std::uint64_t start = 0;
  while (!banks.must_start_over(start)) banks.move_to(++start);
  for (std::uint64_t tick = start; tick < start + 100; ++tick) EXPECT_EQ(banks.claim(tick, 0), 0U);
  const auto* row = banks.row(start + 50);
  const auto moved = banks.start_over(start + 10, start + 99);
  EXPECT_EQ(banks.row(start + 50), row - moved);
  EXPECT_FALSE(banks.must_start_over(start + 10));
  EXPECT_EQ(banks.claim(start + 10, 0), 90U);
  EXPECT_EQ(banks.claim(start + 10, 4), 0U);
  for (std::uint64_t tick = start + 101; tick < start + 4000; ++tick) EXPECT_EQ(banks.claim(tick, 0), 0U) << tick;
}

TEST(Banks, AreFreeAfterALongSleep) {
  Banks banks(16);
  for (std::uint64_t tick = 0; tick < 100; ++tick) EXPECT_EQ(banks.claim(tick, 0), 0U);
  banks.start_over(1'000'000'000, 99);
  for (std::uint64_t tick = 0; tick < 2000; ++tick) EXPECT_EQ(banks.claim(1'000'000'000 + tick, 0), 0U) << tick;
}

TEST(Banks, StateDoesNotDependOnTheStartOfTheTable) {
  Banks early(16);
  Banks late(16);
  early.move_to(5000);
  late.start_over(5000, 0);
  for (auto* banks : {&early, &late}) {
    banks->claim(5003, 8);
    banks->claim(5003, 8);
  }
  EXPECT_TRUE(mebots::test::same_state(early, late));
  Banks restored(16);
  restored.claim(7, 8);
  state::restore(restored, state::save(early));
  EXPECT_EQ(restored.claim(5003, 8), 2U);
  EXPECT_EQ(restored.claim(5007, 8), 0U);
}

constexpr std::string_view kTwentyWords = R"(
    la a0, data
    li a1, 20
1:  lw a2, 0(a0)
    sw a2, 4(a0)
    addi a1, a1, -1
    bnez a1, 1b
)";

std::uint64_t cycles_with(std::uint32_t wait_cycles, BankSchedule* banks, std::string_view body = kTwentyWords) {
  Machine machine(std::string(body) + std::string(kEnd) + ".data\n.balign 64\ndata: .zero 64\n");
  const MemoryPort port{0, wait_cycles, banks};
  machine.hart().connect({&port, 1});
  EXPECT_EQ(machine.run(), Stop::watch);
  return machine.hart().counters().cycles;
}

TEST(MemoryPort, WaitIsAddedToEveryLoadAndStore) {
  EXPECT_EQ(cycles_with(7, nullptr), cycles_with(0, nullptr) + 7 * (20 + 20 + 1));
}

TEST(MemoryPort, MisalignedAccessWaitsTwice) {
  constexpr std::string_view kBody = "la a0, data\n lw a1, 2(a0)\n sw a1, 6(a0)\n";
  EXPECT_EQ(cycles_with(7, nullptr, kBody), cycles_with(0, nullptr, kBody) + 7 * (2 + 2 + 1));
}

TEST(MemoryPort, BanksWithoutOtherUsersCostNothing) {
  Banks banks;
  BankSchedule schedule(banks);
  EXPECT_EQ(cycles_with(0, &schedule), cycles_with(0, nullptr));
}

TEST(MemoryPort, LimitStopsAtTheSameInstructionWithWaits) {
  // A run must execute exactly those instructions that start before its limit.
  const auto program = assemble(std::string(kTwentyWords) + std::string(kEnd) + ".data\n.balign 64\ndata: .zero 64\n");
  for (std::uint64_t limit = 1; limit < 120; ++limit) {
    Machine cut(program);
    Machine stepped(program);
    const MemoryPort port{0, 7, nullptr};
    cut.hart().connect({&port, 1});
    stepped.hart().connect({&port, 1});
    cut.run(limit);
    for (std::uint64_t at = 1; at <= limit; ++at) stepped.run(at);
    EXPECT_EQ(cut.hart().pc(), stepped.hart().pc()) << limit;
    EXPECT_EQ(cut.hart().counters().cycles, stepped.hart().counters().cycles) << limit;
  }
}

TEST(MemoryPort, AnUnconnectedMemoryIsNotAccessible) {
  Machine machine("li a0, 0x70000000\n lw a1, 0(a0)\n" + std::string(kEnd));
  const MemoryPort port{0, 0, nullptr};
  machine.hart().connect({&port, 1});
  EXPECT_EQ(machine.run(), Stop::fault);
  EXPECT_EQ(machine.hart().fault().last.value, 0x70000000U);
}

TEST(CodeGeneration, AStoreInvalidatesTheCodeThatAnotherCoreDecoded) {
  Machine machine(R"(
    li a0, 0
again:
    addi a0, a0, 1
    j again
)");
  class Nothing final : public Bus {
    BusReply load(std::uint32_t, std::uint64_t) override { return {}; }
    BusReply store(std::uint32_t, std::uint64_t, std::uint32_t) override { return {}; }
    bool watched(std::uint32_t) override { return false; }
  } nothing;
  machine.run(100);
  const auto writer =
      assemble("la a0, 0x80000004\n la a1, 2f\n lw a1, 0(a1)\n sw a1, 0(a0)\n1: j 1b\n .option norvc\n2: j .");
  for (const auto& segment : writer.segments()) machine.memory().write(0x80001000, segment.bytes);
  DecodedCode code(machine.memory(), {});
  Hart other(machine.memory(), nothing, code);
  other.reset(0x80001000);
  const auto before = machine.reg(10);
  other.run(200);
  machine.run(300);
  EXPECT_LE(machine.reg(10), before + 1);
}

}  // namespace
}  // namespace mebots::soc::test
