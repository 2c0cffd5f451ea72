// SPDX-License-Identifier: Apache-2.0
// Tests RI5CY's event counters. Expected counts follow from the events' definitions (RI5CY user manual 4.45,
// "Performance counters") and the instructions of each program.
#include "hart/observer.hpp"
#include "machine.hpp"
#include "mebots/state/save.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <string>

namespace mebots::soc::test {
namespace {

using Counts = std::array<std::uint32_t, 17>;

/// Returns a program that counts the events of `body`. The count begins with the instruction after the one that starts
/// the counters, and ends with the instruction that stops them.
std::string program_of(std::string_view body) {
  auto text = fmt::format(R"(
_start: .option norvc
    la a0, buffer
    li a2, 0x80
    li t3, 0
    li t4, -1
    csrwi 0x7a1, 0
    csrw 0x7a0, t4
    csrw 0x79f, zero
    csrwi 0x7a1, 1
{}
    csrwi 0x7a1, 0
    la s0, results
)",
                          body);
  for (unsigned i = 0; i < Counts().size(); ++i)
    text += fmt::format("    csrr s1, {}\n    sw s1, {}(s0)\n", 0x780 + i, 4 * i);
  return text + std::string(kEnd) + R"(
    .data
    .balign 64
buffer: .space 64
    .globl results
results: .space 128
)";
}

Counts counts_of(Machine& machine) {
  EXPECT_EQ(machine.run(), Stop::watch);
  Counts counts{};
  for (std::uint32_t i = 0; i < counts.size(); ++i) counts[i] = machine.word("results", i);
  return counts;
}

Counts counts_of(std::string_view body, bool translate = true) {
  Machine machine(assemble(program_of(body)), {.kind = CoreKind::ri5cy, .translate = translate});
  return counts_of(machine);
}

TEST(EventCounters, CountWhatTheProgramDoes) {
  const auto counts = counts_of(R"(
    lw a1, 0(a0)
    addi a1, a1, 1
    sw a1, 4(a0)
    lw a3, 2(a0)
    nop
    beq zero, zero, 1f
1:  bne zero, zero, 1b
    jal ra, 2f
2:  la t0, 3f
    jalr zero, 0(t0)
3:  .option rvc
    c.nop
    c.nop
    .option norvc
)");
  EXPECT_EQ(counts[2], 1U) << "load stalls: addi needs a1";
  EXPECT_EQ(counts[3], 1U) << "jump stalls: jalr needs t0";
  EXPECT_EQ(counts[4], 0U) << "there is no instruction cache";
  EXPECT_EQ(counts[5], 3U) << "loads: one of two crosses a word and counts twice";
  EXPECT_EQ(counts[6], 1U) << "stores";
  EXPECT_EQ(counts[7], 2U) << "jumps";
  EXPECT_EQ(counts[8], 2U) << "branches";
  EXPECT_EQ(counts[9], 1U) << "taken branches";
  EXPECT_EQ(counts[10], 2U) << "compressed instructions";
}

constexpr std::string_view kLoop = R"(
    li t2, 1000
1:  lw a1, 0(a0)
    add t3, t3, a1
    sw t3, 4(a0)
    andi a3, t2, 3
    bnez a3, 2f
    div a4, t3, t2
2:  addi t2, t2, -1
    bnez t2, 1b
)";

TEST(EventCounters, OfALoopFollowFromItsTurns) {
  const auto counts = counts_of(kLoop);
  EXPECT_EQ(counts[2], 1000U);
  EXPECT_EQ(counts[5], 1000U);
  EXPECT_EQ(counts[6], 1000U);
  EXPECT_EQ(counts[8], 2000U);
  EXPECT_EQ(counts[9], 750U + 999U);
  EXPECT_EQ(counts[10], 0U);
}

class Silent final : public Observer {};

TEST(EventCounters, AreTheSameInterpretedTranslatedAndObserved) {
  const auto translated = counts_of(kLoop);
  EXPECT_EQ(counts_of(kLoop, false), translated);
  Machine machine(assemble(program_of(kLoop)), CoreKind::ri5cy);
  Silent observer;
  machine.hart().observe(&observer);
  EXPECT_EQ(counts_of(machine), translated);
}

TEST(EventCounters, AreTheSameRestoredBetweenALoadAndTheJumpThatNeedsIt) {
  const auto program = assemble(program_of(R"(
    la t0, 1f
    sw t0, 0(a0)
    lw t1, 0(a0)
    jalr zero, 0(t1)
1:  nop
)"));
  Machine straight(program, CoreKind::ri5cy);
  const auto counts = counts_of(straight);
  EXPECT_EQ(counts[2], 1U) << "the jump waits for its load";
  Machine broken(program, CoreKind::ri5cy);
  auto stop = Stop::limit;
  for (std::uint64_t limit = 1; stop == Stop::limit; ++limit) {
    stop = broken.run(limit);
    state::restore(broken.hart(), state::save(broken.hart()));
  }
  EXPECT_EQ(stop, Stop::watch);
  for (std::uint32_t i = 0; i < counts.size(); ++i) EXPECT_EQ(broken.word("results", i), counts[i]) << "event " << i;
}

TEST(EventCounters, DoNotChangeTheCycles) {
  const auto cycles_of = [](std::string_view enable) {
    Machine machine(
        assemble(fmt::format("_start: la a0, buffer\n li t4, {}\n csrw 0x7a0, t4\n{}{}\n .data\nbuffer: .space 64\n",
                             enable, kLoop, kEnd)),
        CoreKind::ri5cy);
    EXPECT_EQ(machine.run(), Stop::watch);
    return machine.hart().counters().cycles;
  };
  EXPECT_EQ(cycles_of("-1"), cycles_of("3"));
}

TEST(EventCounters, CountInstructionsThatWaitForTheCache) {
  Machine machine(
      assemble(program_of(kLoop)),
      {.kind = CoreKind::ri5cy, .instruction_cache = {.size = 1024, .line = 16, .ways = 4, .refill_cycles = 10}});
  const auto counts = counts_of(machine);
  EXPECT_GT(counts[4], 0U);
  EXPECT_EQ(counts[4] % 10, 0U) << "each refill takes ten cycles";
}

}  // namespace
}  // namespace mebots::soc::test
