// SPDX-License-Identifier: Apache-2.0
// Compares translated code with the interpreter: both must have the same state and counts at every limit.
#include "board_system.hpp"
#include "machine.hpp"
#include "random_program.hpp"
#include "support/same_state.hpp"
#include "translate/translator.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace mebots::soc::test {
namespace {

std::vector<std::byte> state_of(Machine& machine, bool with_memory) {
  state::Writer writer;
  if (with_memory) state::save(machine.memory(), writer);
  if (auto* cache = machine.instruction_cache(); cache != nullptr) state::save(*cache, writer);
  state::save(machine.hart(), writer);
  return writer.take();
}

std::string text_of(Machine& machine) {
  const auto& c = machine.hart().counters();
  auto text = fmt::format("pc {:08x}, {} instructions, {} cycles, {} fJ, {} accesses, {} far", machine.hart().pc(),
                          c.instructions, c.cycles, c.instruction_fj, c.accesses, c.far_accesses);
  for (unsigned i = 1; i < 32; ++i) text += fmt::format("{}x{} {:08x}", i % 8 == 1 ? "\n" : " ", i, machine.reg(i));
  return text;
}

/// The cache is small, so lines are often evicted.
InstructionCacheSettings small_cache(std::uint32_t bytes) {
  return {bytes, 16, 2, 7};
}

/// Two runs of one program.
struct Pair {
  explicit Pair(const Elf& program, const MachineSettings& settings = {})
      : translated(program, settings), interpreted(program, without_translation(settings)) {}

  void wait_for_memory(std::uint32_t first, std::uint32_t second) {
    for (auto* machine : {&translated, &interpreted}) {
      const std::array ports{MemoryPort{0, first, nullptr}, MemoryPort{1, second, nullptr}};
      machine->hart().connect(ports);
    }
  }

  /// Continues and compares both runs. Returns false if they differ, or have ended.
  bool run(std::uint64_t limit) {
    const auto stop = translated.run(limit);
    EXPECT_EQ(stop, interpreted.run(limit));
    // The memory is compared rarely: it is large, and differences in it remain.
    const bool with_memory = stop != Stop::limit || ++stops_ % 256 == 0;
    const bool same = state_of(translated, with_memory) == state_of(interpreted, with_memory);
    EXPECT_TRUE(same) << "translated: " << text_of(translated) << "\ninterpreted: " << text_of(interpreted);
    return same && stop == Stop::limit;
  }

  Machine translated;
  Machine interpreted;

 private:
  static MachineSettings without_translation(MachineSettings settings) {
    settings.translate = false;
    return settings;
  }

  int stops_ = 0;
};

/// Runs to the end with limits of all sizes, interrupts at any time, and restored states.
void compare_at_random_limits(Pair& pair, std::uint32_t seed) {
  std::mt19937 random(seed);
  bool continues = true;
  for (int stops = 0; continues && stops < 4000; ++stops) {
    const auto limit = pair.translated.hart().counters().cycles + 1 + random() % (random() % 4 == 0 ? 20000 : 80);
    continues = pair.run(limit);
    const auto chance = random() % 256;
    for (auto* machine : {&pair.translated, &pair.interpreted}) {
      machine->hart().set_interrupt(chance % 2 == 0 ? 11 : 7, chance < 4);
      if (chance == 255) {
        state::restore(machine->hart(), state::save(machine->hart()));
      }
    }
  }
  for (auto* machine : {&pair.translated, &pair.interpreted}) {
    machine->hart().set_interrupt(11, false);
    machine->hart().set_interrupt(7, false);
  }
  if (continues) pair.run(1'000'000'000);
  EXPECT_EQ(pair.translated.word("tohost"), 1U);
}

class RandomProgram : public testing::TestWithParam<std::uint32_t> {};

TEST_P(RandomProgram, RunsTranslatedAsInterpreted) {
  const auto seed = GetParam();
  const auto program = assemble(random_program(seed));
  Pair straight(program, {.kind = seed % 2 == 0 ? CoreKind::cv32e40p : CoreKind::ri5cy});
  straight.run(1'000'000'000);
  EXPECT_EQ(straight.translated.word("tohost"), 1U);
  Pair pair(program, {.kind = seed % 2 == 0 ? CoreKind::ri5cy : CoreKind::cv32e40p});
  compare_at_random_limits(pair, seed);
  Pair waiting(program);
  waiting.wait_for_memory(seed % 4, seed / 2 % 4);
  compare_at_random_limits(waiting, seed + 1);
  Pair fetching(program, {.instruction_cache = small_cache(128U << seed % 6)});
  compare_at_random_limits(fetching, seed + 2);
}

TEST_P(RandomProgram, CountsTheSameForAllLimits) {
  const auto seed = GetParam();
  const auto program = assemble(random_program(seed));
  for (const bool cached : {false, true}) {
    MachineSettings settings{.kind = seed % 2 == 0 ? CoreKind::cv32e40p : CoreKind::ri5cy};
    if (cached) settings.instruction_cache = small_cache(128U << seed % 6);
    Pair pair(program, settings);
    pair.wait_for_memory(seed % 4, seed / 2 % 4);
    auto& seldom = pair.interpreted;
    auto& often = pair.translated;
    std::mt19937 random(seed);
    auto stop = Stop::limit;
    bool same = true;
    while (stop == Stop::limit && same) {
      const auto now = often.hart().counters().cycles;
      const auto limit = now + 60 + random() % 200;
      for (auto cut = now; stop == Stop::limit && cut < limit;) {
        cut = std::min(limit, cut + 1 + random() % 20);
        stop = often.run(cut);
      }
      EXPECT_EQ(stop, seldom.run(limit));
      same = state_of(often, stop != Stop::limit) == state_of(seldom, stop != Stop::limit);
    }
    EXPECT_TRUE(same) << "often cut: " << text_of(often) << "\nseldom: " << text_of(seldom);
    EXPECT_EQ(often.word("tohost"), 1U);
  }
}

INSTANTIATE_TEST_SUITE_P(Translation, RandomProgram, testing::Range(1U, 41U));

/// Only rare instructions have no translation. Each new instruction needs a translation or an entry here.
TEST(Translation, ExistsForEveryCommonInstruction) {
  if (!translate::can_translate()) GTEST_SKIP() << "this build or host translates nothing";
  const std::set<Op> rare{Op::illegal, Op::ebreak, Op::fence_i, Op::wfi, Op::p_elw, Op::p_clb, Op::fclass_s};
  for (const auto& row : encodings()) {
    EXPECT_EQ(translate::has_translation(row.op), !rare.contains(row.op) && !is_atomic(row.op)) << row.name;
  }
}

TEST(Translation, ClearsThePipelineStateWhenAJumpEntersTheSameBlock) {
  // Label 2 is directly after 64 instructions, the last of which is a load. In every second iteration, the branch "beqz
  // t0, 2b" jumps to label 2 instead. In every fourth iteration, the store at label 2 is into the watched word
  // (tohost), so the interpreter executes the rest of the block. The compared state contains the pipeline state, so it
  // shows whether the interpreter assumes the load before label 2.
  std::string body = "    .option push\n    .option norvc\n";
  for (int i = 0; i < 63; ++i) body += "    addi a2, a2, 3\n";
  const auto program = assemble(R"(
_start: la s0, data
    la s6, tohost
    mv s5, s0
    li s1, 6000
1:
)" + body + R"(    lw a1, 0(s0)
2:  sw zero, 0(s5)
    addi s1, s1, -1
    andi t0, s1, 3
    mv s5, s0
    bnez t0, 3f
    mv s5, s6
3:  andi t0, s1, 1
    beqz t0, 2b
    bnez s1, 1b
    .option pop
)" + std::string(kEnd) + R"(
    .data
    .balign 4
data: .word 0
)");
  // Like a core of a cluster, the hart completes a block that starts before the limit, so it can stop after the store.
  Pair pair(program, {.kind = CoreKind::ri5cy, .loose_limit = true});
  std::mt19937 random(7);
  bool same = true;
  for (int stops = 0; same && stops < 20000; ++stops) {
    same = pair.run(pair.translated.hart().counters().cycles + 1 + random() % 90);
  }
  EXPECT_TRUE(same) << "the program, which never ends, ended";
}

/// The code after the branch of a hot block is reached only in every 64th iteration, so its lines are then absent from
/// the instruction cache. Translated code executes the part up to the branch. If the part after the branch, with all
/// its refills, might exceed the limit, translated code stops before this part.
TEST(Translation, FetchesTheRareEndOfABlock) {
  const auto program = assemble(R"(
    li a3, 20
again: addi a0, a0, 1
    andi a1, a0, 63
    bnez a1, ahead
    .rept 30
    addi a2, a2, 3
    mul a4, a2, a0
    .endr
    fence.i
    addi a3, a3, -1
    beqz a3, done
ahead: .rept 60
    addi a5, a5, 1
    .endr
    j again
done:
)" + std::string(kEnd));
  for (const std::uint64_t step : {1, 61, 211, 307, 997}) {
    Pair pair(program, {.instruction_cache = small_cache(1024)});
    for (std::uint64_t limit = step; pair.run(limit); limit += step) ASSERT_LT(limit, 200'000U);
    EXPECT_EQ(pair.translated.word("tohost"), 1U);
    const bool has_room = step > 200;
    EXPECT_EQ(pair.translated.hart().code().is_translated(), has_room && translate::can_translate()) << step;
    EXPECT_FALSE(pair.interpreted.hart().code().is_translated());
  }
}

TEST(Translation, FetchesNoLineTooEarlyWhenItLeavesABlock) {
  // Each block has many cache lines, and execution leaves it in its middle: at loads from two clocks, which return the
  // cycle, and at stores into code. After the loop, another part of the code evicts lines of the loop.
  const std::string straight = "    .rept 25\n    addi a2, a2, 3\n    .endr\n";
  const auto program = assemble(R"(
    .option norvc
_start: li s1, 3000
    la s2, places
1:  andi t0, s1, 7
    slli t0, t0, 3
    add t0, t0, s2
    lw s3, 0(t0)
    lw s4, 4(t0)
)" + straight + R"(
    lw a0, 0(s3)
    xor a3, a3, a0
)" + straight + R"(
    sw a2, 0(s4)
    mul a3, a3, a0
)" + straight + R"(
    lw a1, 0(s3)
    add a3, a3, a1
    andi t0, s1, 3
    bnez t0, 2f
)" + straight + straight + R"(
2:  addi s1, s1, -1
    bnez s1, 1b
    j done
patch: .word 0
done:
)" + std::string(kEnd) +
                                fmt::format(R"(
    .data
    .balign 4
data: .word 0, 0
places: .word data, data, {0}, data, data, data, {1}, data
    .word {0}, data, data, patch, data, data, {0}, data
)",
                                            Machine::kQuietClock, Machine::kClock));
  for (const std::uint32_t bytes : {128, 512, 1024, 2048}) {
    for (const std::uint64_t step : {97, 1013, 1'000'000}) {
      Pair pair(program, {.instruction_cache = small_cache(bytes)});
      pair.wait_for_memory(bytes == 512 ? 1 : 0, 2);
      auto stop = Stop::limit;
      std::uint64_t limit = 0;
      while (stop == Stop::limit || stop == Stop::device) {
        if (stop == Stop::limit) limit += step;
        stop = pair.translated.run(limit);
        ASSERT_EQ(stop, pair.interpreted.run(limit));
        ASSERT_EQ(state_of(pair.translated, false), state_of(pair.interpreted, false))
            << bytes << " bytes\ntranslated: " << text_of(pair.translated)
            << "\ninterpreted: " << text_of(pair.interpreted);
      }
      EXPECT_EQ(pair.translated.word("tohost"), 1U);
    }
  }
}

TEST(Translation, TakesTrapsAsTheInterpreter) {
  // Two ecalls, one of them the first instruction of its block. The handler sometimes raises another exception, moves
  // the trap vector, returns elsewhere, or disables interrupts. Timer interrupts come at random times.
  const auto program = assemble(R"(
_start: la s0, handler
    csrw mtvec, s0
    li t0, 1 << 7 | 1 << 11
    csrw mie, t0
    la s2, counts
    li s1, 20000
1:  csrsi mstatus, 8
    addi a2, a2, 3
    ecall
    lw a0, 0(s2)
    j 2f
    .balign 4
2:  ecall
    add a1, a1, a0
    addi s1, s1, -1
    bnez s1, 1b
    j done
    .balign 256
handler: csrr t0, mcause
    bltz t0, interrupt
    csrr t1, mepc
    lw t2, 0(s2)
    addi t2, t2, 1
    sw t2, 0(s2)
    andi t3, t2, 127
    bnez t3, 3f
    la t4, other
    csrw mtvec, t4
3:  andi t3, t2, 255
    addi t3, t3, -9
    bnez t3, 4f
    la t4, skip
    csrw mtvec, t4
    ecall
    .balign 256
skip: csrw mtvec, s0
4:  andi t3, t2, 511
    addi t3, t3, -77
    bnez t3, 5f
    li t3, 1 << 7
    csrc mstatus, t3
5:  addi t1, t1, 4
    csrw mepc, t1
    mret
interrupt: lw t2, 4(s2)
    addi t2, t2, 1
    sw t2, 4(s2)
    mret
    .balign 256
other: csrw mtvec, s0
    csrr t1, mepc
    addi t1, t1, 4
    csrw mepc, t1
    mret
done:
)" + std::string(kEnd) + R"(
    .data
    .balign 4
counts: .word 0, 0
)");
  for (const auto kind : {CoreKind::rv32imc, CoreKind::cv32e40p, CoreKind::ri5cy}) {
    for (const std::uint32_t bytes : {0, 128, 1024}) {
      MachineSettings settings{.kind = kind, .options = Extension::user};
      if (bytes != 0) settings.instruction_cache = small_cache(bytes);
      for (std::uint32_t seed = 0; seed < 4; ++seed) {
        Pair pair(program, settings);
        compare_at_random_limits(pair, seed);
        settings.options = {};
      }
    }
  }
}

TEST(Translation, FollowsStoresIntoCode) {
  // The outer loop changes the body of a hot inner loop.
  Pair pair(assemble(std::string(R"(
_start: li s0, 40
    la s1, patch
    la s2, words
1:  andi t0, s0, 4
    add t0, t0, s2
    lw t0, 0(t0)
    sw t0, 0(s1)
    li t1, 500
2:
    .balign 4
    .option push
    .option norvc
patch: addi a0, a0, 1
    .option pop
    addi t1, t1, -1
    bnez t1, 2b
    addi s0, s0, -1
    bnez s0, 1b
    j done
    .balign 4
    .option norvc
words: addi a0, a0, 3
    xori a0, a0, 5
    .option rvc
done:
)") + std::string(kEnd)));
  for (std::uint64_t limit = 777; pair.run(limit); limit += 777) {
  }
  EXPECT_EQ(pair.translated.word("tohost"), 1U);
}

TEST(Translation, LeavesFaultsToTheInterpreter) {
  // In the hot loop, the address of the load increases until it is beyond the memory. Then the load faults.
  Pair pair(assemble(R"(
_start: li s0, 0x800f0000
1:  lw a0, 0(s0)
    addi s0, s0, 4
    j 1b
)"));
  pair.run(1'000'000'000);
  EXPECT_TRUE(pair.translated.hart().fault().happened);
  EXPECT_EQ(pair.translated.hart().fault().last.value, 0x80100000U);
}

TEST(Translation, KeepsEveryBitOfTheStateOfABusyBoard) {
  const auto program = BoardSystem::assembled(R"(
_start: la t0, handler
    csrw mtvec, t0
    li s0, TIMER_BASE
    li s4, POWER_MANAGER_BASE
    li s5, 0x1B000000
    li s3, 70000
    sw s3, TIMER_COMPARE_LO_OFFSET(s0)
    sw zero, TIMER_COMPARE_HI_OFFSET(s0)
    li a0, 1 << TIMER_INTERRUPT
    csrw mie, a0
    csrwi mstatus, 8
1:  li a0, 900
2:  addi a0, a0, -1
    div a1, s3, a0
    sw a1, 1(s5)
    lw a2, 1(s5)
    sw a2, 8(s5)
    add a3, a3, a2
    andi a4, a0, 63
    bnez a4, 3f
    lw a5, TIMER_COMPARE_LO_OFFSET(s0)
    add a3, a3, a5
3:  bnez a0, 2b
    li a0, 1000
    sw a0, POWER_MANAGER_VOLTAGE_MV_OFFSET(s4)
    li a0, 1200
    sw a0, POWER_MANAGER_VOLTAGE_MV_OFFSET(s4)
    wfi
    j 1b
    .balign 4
handler: sw t0, 16(s5)
    lw t0, TIMER_COMPARE_LO_OFFSET(s0)
    add t0, t0, s3
    sw t0, TIMER_COMPARE_LO_OFFSET(s0)
    lw t0, 16(s5)
    mret
)");
  Settings settings;
  BoardSystem translated(program, settings);
  settings.translate = false;
  BoardSystem interpreted(program, settings);
  for (std::int64_t time_ns = 0; time_ns < 20'000'000; time_ns += 333'333) {
    translated.soc.advance(time_ns);
    interpreted.soc.advance(time_ns);
    ASSERT_TRUE(mebots::test::same_state(translated.soc, interpreted.soc)) << "at " << time_ns << " ns";
    ASSERT_EQ(translated.soc.energy().total_j(), interpreted.soc.energy().total_j());
  }
  EXPECT_TRUE(translated.faults.empty());
  EXPECT_GT(translated.soc.hart().counters().instructions, 300'000U);
}

}  // namespace
}  // namespace mebots::soc::test
