// SPDX-License-Identifier: Apache-2.0
#include "hart/csr_numbers.hpp"
#include "isa/encoding.hpp"
#include "machine.hpp"
#include "support/same_state.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

namespace mebots::soc::test {
namespace {

/// Returns a program with a handler that stores mcause, mepc and mtval in s2, s3, s4, and continues after an
/// instruction of 4 bytes.
std::string with_handler(std::string_view body) {
  return fmt::format(R"(
_start: .option norvc
    la t0, handler
    csrw mtvec, t0
    {}
    {}
    .balign 4
handler: csrr s2, mcause
    csrr s3, mepc
    csrr s4, mtval
    addi t1, s3, 4
    csrw mepc, t1
    mret
)",
                     body, kEnd);
}

struct Expected {
  std::string body;
  std::uint32_t cause;
  std::uint32_t value;
};

TEST(Trap, ReportsCauseAddressAndInstruction) {
  const std::vector<Expected> cases{
      {"li a1, 7\nat: ecall\nli a1, 8", cause::kMachineEcall, 0},
      {"li a1, 7\nat: .word 0xffffffff\nli a1, 8", cause::kIllegalInstruction, 0xffffffff},
      {"li a1, 7\nat: .half 0\n.half 0x0001\nli a1, 8", cause::kIllegalInstruction, 0},
      {"li a1, 7\nat: csrr a0, 0x7c0\nli a1, 8", cause::kIllegalInstruction, 0x7c002573},
      {"li a1, 7\nat: csrw mhartid, a1\nli a1, 8", cause::kIllegalInstruction, 0xf1459073},
      {"li a0, 0x1000\nli a1, 7\nat: lw a2, 4(a0)\nli a1, 8", cause::kLoadAccess, 0x1004},
      {"li a0, 0x1000\nli a1, 7\nat: sb a2, -1(a0)\nli a1, 8", cause::kStoreAccess, 0xfff},
      {"li a0, 0x800ffffe\nli a1, 7\nat: lw a2, 0(a0)\nli a1, 8", cause::kLoadAccess, 0x800ffffe},
  };
  for (const auto& expected : cases) {
    Machine machine(with_handler(expected.body));
    ASSERT_EQ(machine.run(), Stop::watch) << expected.body;
    EXPECT_EQ(machine.reg(18), expected.cause) << expected.body;
    EXPECT_EQ(machine.reg(19), *machine.program().symbol("at")) << expected.body;
    EXPECT_EQ(machine.reg(20), expected.value) << expected.body;
    EXPECT_EQ(machine.reg(11), 8U) << "continued after it: " << expected.body;
  }
}

TEST(Trap, HasTheTargetAsPcForAFetchWithoutMemory) {
  Machine machine(fmt::format(R"(
_start: la t0, handler
    csrw mtvec, t0
    li t1, 0x4000
    la ra, back
    jr t1
back: {}
    .balign 4
handler: csrr s2, mcause
    csrr s3, mepc
    csrr s4, mtval
    csrw mepc, ra
    mret
)",
                              kEnd));
  ASSERT_EQ(machine.run(), Stop::watch);
  EXPECT_EQ(machine.reg(18), cause::kFetchAccess);
  EXPECT_EQ(machine.reg(19), 0x4000U);
  EXPECT_EQ(machine.reg(20), 0x4000U);
}

TEST(Trap, DoesNotCountTheInstructionAsRetired) {
  Machine machine(with_handler("csrr s5, minstret\necall\ncsrr s6, minstret"));
  ASSERT_EQ(machine.run(), Stop::watch);
  // The difference of the counts includes the first csrr and six instructions of the handler, but not the ecall.
  EXPECT_EQ(machine.reg(22) - machine.reg(21), 7U);
}

TEST(Trap, EndsTheCoreWithItsCauseIfThereIsNoHandler) {
  Machine machine("_start: nop\nat: .word 0xffffffff\n");
  ASSERT_EQ(machine.run(), Stop::fault);
  EXPECT_FALSE(machine.hart().fault().double_trap);
  EXPECT_EQ(machine.hart().fault().last.cause, cause::kIllegalInstruction);
  EXPECT_EQ(machine.hart().fault().last.pc, *machine.program().symbol("at"));
  EXPECT_EQ(machine.hart().fault().last.instruction, 0xffffffffU);
  EXPECT_EQ(machine.run(), Stop::fault) << "stays so";
}

TEST(Trap, RepeatedInItsOwnHandlerEndsTheCore) {
  Machine machine(
      "_start: la t0, handler\ncsrw mtvec, t0\nli sp, 0x100\nsw a0, 0(sp)\n.balign 4\nhandler: addi sp, sp, -16\n"
      "at: sw a0, 0(sp)\nmret\n");
  ASSERT_EQ(machine.run(), Stop::fault) << "a stack that grew into nothing, met by a handler that pushes";
  EXPECT_TRUE(machine.hart().fault().double_trap);
  EXPECT_EQ(machine.hart().fault().last.cause, cause::kStoreAccess);
  EXPECT_EQ(machine.hart().fault().last.pc, *machine.program().symbol("at"));
}

TEST(Csr, KeepsOnlyItsBits) {
  Machine machine(fmt::format(R"(
_start: li t0, -1
    csrw mstatus, t0
    csrr s2, mstatus
    csrw mie, t0
    csrr s3, mie
    csrw mtvec, t0
    csrr s4, mtvec
    csrw mepc, t0
    csrr s5, mepc
    csrw mip, t0
    csrr s6, mip
    csrr s7, misa
    csrr s8, mhartid
    csrw mscratch, t0
    csrrc s9, mscratch, 5
    csrr s10, mscratch
    csrrwi s11, mhpmcounter7, 31
    csrr a0, mhpmcounter7
    csrw mhpmevent31, t0
    csrr a1, mhpmevent31
    {}
)",
                              kEnd));
  ASSERT_EQ(machine.run(), Stop::watch);
  EXPECT_EQ(machine.reg(18), 0x00001888U) << "machine mode, MIE, MPIE";
  EXPECT_EQ(machine.reg(19), 0xffff0888U);
  EXPECT_EQ(machine.reg(20), 0xfffffffdU) << "direct or vectored";
  EXPECT_EQ(machine.reg(21), 0xfffffffeU);
  EXPECT_EQ(machine.reg(22), 0U);
  EXPECT_EQ(machine.reg(23), 0x40001104U) << "RV32IMC";
  EXPECT_EQ(machine.reg(24), 0U);
  EXPECT_EQ(machine.reg(25), 0xffffffffU);
  EXPECT_EQ(machine.reg(26), 0xfffffffaU);
  EXPECT_EQ(machine.reg(27), 0U);
  EXPECT_EQ(machine.reg(10), 0U);
  EXPECT_EQ(machine.reg(11), 0U);
}

TEST(Csr, KeepsTheBitsOfTheManualOnCv32e40p) {
  Machine machine(fmt::format(R"(
_start: .option norvc
    csrr s2, mtvec
    csrr s3, mcountinhibit
    csrr s4, mcycle
    nop
    csrr s5, mcycle
    csrr s6, minstret
    li t0, -1
    csrw mcountinhibit, t0
    csrr s7, mcountinhibit
    csrw mtval, t0
    csrr s8, mtval
    csrwi mcountinhibit, 4
    csrr s9, mcycle
    csrr s10, mcycle
    la t0, handler + 1
    csrw mtvec, t0
    csrr s11, mtvec
    lw a0, 0(zero)
    .balign 256
    li a0, 99
    j end
handler: li a0, 1
end: {}
)",
                              kEnd),
                  CoreKind::cv32e40p);
  ASSERT_EQ(machine.run(), Stop::watch);
  EXPECT_EQ(machine.reg(18), 1U) << "vectored";
  EXPECT_EQ(machine.reg(19), 0xdU);
  EXPECT_EQ(machine.reg(20), 0U) << "mcycle is stopped";
  EXPECT_EQ(machine.reg(21), 0U);
  EXPECT_EQ(machine.reg(22), 0U);
  EXPECT_EQ(machine.reg(23), 0xdU) << "counters 0, 2 and 3";
  EXPECT_EQ(machine.reg(24), 0U) << "mtval is read-only";
  EXPECT_EQ(machine.reg(26) - machine.reg(25), 4U) << "mcycle runs, and an access takes 4 cycles";
  EXPECT_EQ(machine.reg(27) & 0xffU, 1U) << "aligned to 256 bytes";
  EXPECT_EQ(machine.reg(10), 99U) << "the trap entered the aligned address";
  EXPECT_EQ(machine.hart().csr_remarks().moved_mtvec, *machine.program().symbol("handler") + 1);
  EXPECT_EQ(machine.hart().csr_remarks().read_stopped_counter, csr::kMinstret);
}

/// Returns a program that traps `count` times. Each time, its handler executes `step` and leaves without mret.
std::string leaves_without_mret(unsigned count, std::string_view step) {
  return fmt::format(R"(
_start: la t0, handler
    csrw mtvec, t0
    li s2, {}
again: la t1, counter
    lw t2, 0(t1)
    li t1, 0
    bge t2, s2, done
    li t2, 0
    lw a0, 0(zero)
done: {}
    .balign 4
handler: {}
    la t1, counter
    lw t2, 0(t1)
    addi t2, t2, 1
    sw t2, 0(t1)
    li t1, 0
    li t2, 0
    j again
    .data
counter: .word 0
)",
                     count, kEnd, step);
}

TEST(Trap, WhoseHandlerLeavesWithoutMretIsNoEndlessLoop) {
  Machine counting(leaves_without_mret(1000, "addi s3, s3, 1"));
  EXPECT_EQ(counting.run(), Stop::watch);
  EXPECT_EQ(counting.reg(19), 1000U);
  Machine in_memory(leaves_without_mret(1000, "nop"));
  EXPECT_EQ(in_memory.run(), Stop::watch) << "all registers are the same, and memory is not";
}

TEST(Trap, ByAnEcallSavesNoRegistersOfAnEarlierException) {
  const auto program = assemble(with_handler(".word 0\nli a0, 0\necall"));
  Machine one(program);
  Machine other(program);
  other.hart().set_reg(10, 5);
  for (auto* machine : {&one, &other}) EXPECT_EQ(machine->run(), Stop::watch);
  EXPECT_TRUE(mebots::test::same_state(one.hart(), other.hart()));
}

TEST(Trap, IsForgottenWhenTheCoreIsReset) {
  const auto program = assemble("_start: ebreak");
  Machine reset(program);
  reset.run();
  reset.hart().reset(program.entry());
  Machine fresh(program);
  EXPECT_TRUE(mebots::test::same_state(reset.hart(), fresh.hart()));
}

TEST(Trap, RepeatedWithTheSameStateEndsTheCore) {
  Machine machine("_start: la t0, again\ncsrw mtvec, t0\n.balign 4\nagain: li t1, 5\nj at\nnop\nat: lw a0, 0(zero)\n");
  ASSERT_EQ(machine.run(), Stop::fault);
  EXPECT_TRUE(machine.hart().fault().double_trap);
  EXPECT_LT(machine.hart().counters().instructions, 100U);
  Machine in_memory(leaves_without_mret(2'000'000, "nop"));
  ASSERT_EQ(in_memory.run(100'000'000), Stop::fault) << "the same registers for a million times";
}

TEST(Csr, ReadOfAReadOnlyRegisterBySetWithX0IsNoWrite) {
  Machine machine(fmt::format("_start: csrrs a0, mvendorid, zero\ncsrrci a1, marchid, 0\n{}", kEnd));
  ASSERT_EQ(machine.run(), Stop::watch);
  EXPECT_EQ(machine.reg(10), 0x602U);
  EXPECT_EQ(machine.reg(11), 4U);
}

/// The CSRs of a core, copied from the manuals independently of the product's code.
struct CsrSet {
  std::vector<std::pair<unsigned, unsigned>> there;  // first and last number of each range
  std::vector<std::pair<unsigned, unsigned>> slow;
  std::map<unsigned, std::uint32_t> after_reset;  // all other registers read as 0

  bool has(unsigned number) const { return contains(there, number); }
  static bool contains(const std::vector<std::pair<unsigned, unsigned>>& ranges, unsigned number) {
    return std::ranges::any_of(ranges,
                               [number](const auto& range) { return number >= range.first && number <= range.second; });
  }
};

CsrSet csrs_of(CoreKind kind) {
  CsrSet set;
  set.there = {{0x300, 0x301}, {0x304, 0x305}, {0x320, 0x320}, {0x323, 0x33f}, {0x340, 0x344},
               {0xb00, 0xb00}, {0xb02, 0xb1f}, {0xb80, 0xb80}, {0xb82, 0xb9f}, {0xc00, 0xc00},
               {0xc02, 0xc1f}, {0xc80, 0xc80}, {0xc82, 0xc9f}, {0xf11, 0xf14}};
  set.slow = {{0x300, 0x300}, {0x305, 0x305}, {0x320, 0x33f}, {0x341, 0x342},
              {0xb00, 0xb1f}, {0xb80, 0xb9f}, {0xc00, 0xc1f}, {0xc80, 0xc9f}};
  set.after_reset = {{0x300, 0x1800}, {0x301, 0x40001104}, {0xf11, 0x602}, {0xf12, 4}};
  if (kind == CoreKind::cv32e40p) set.after_reset.insert({{0x305, 1}, {0x320, 0xd}});
  if (kind != CoreKind::ri5cy) return set;
  set.there.insert(set.there.end(), {{0x014, 0x014}, {0x780, 0x7a1}, {0x7b0, 0x7b2}, {0x7b4, 0x7b6}, {0xcc0, 0xcc1}});
  set.slow = {{0x300, 0x300}};
  set.after_reset[0x7a1] = set.after_reset[0xcc1] = 3;
  set.after_reset[0xc10] = 3;  // reads the privilege mode, not an event counter
  return set;
}

TEST(Csr, MatchesTheManualsInPresenceAccessAndCycles) {
  for (const auto kind : {CoreKind::cv32e40p, CoreKind::ri5cy, CoreKind::rv32imc}) {
    const auto expected = csrs_of(kind);
    const Timing timing{kind};
    Machine machine(fmt::format("_start: nop\n{}", kEnd), kind);
    for (unsigned number = 0; number < 0x1000; ++number) {
      const auto text = fmt::format("0x{:03x}", number);
      std::uint32_t value = 1;
      ASSERT_EQ(machine.hart().csr(number, value), expected.has(number)) << text;
      if (!expected.has(number)) continue;
      const auto reset = expected.after_reset.find(number);
      ASSERT_EQ(value, reset == expected.after_reset.end() ? 0 : reset->second) << text;
      ASSERT_EQ(timing.csr_cycles(number), CsrSet::contains(expected.slow, number) ? 4U : 1U) << text;
    }
    for (unsigned number = 0; number < 0x1000; ++number) {
      // The user-mode CSRs PCER and PCMR have numbers in the range of read-only registers, but programs can store to
      // them.
      const bool can_be_stored_to = number < 0xc00 || number == 0xcc0 || number == 0xcc1;
      ASSERT_EQ(machine.hart().set_csr(number, 0), expected.has(number) && can_be_stored_to)
          << fmt::format("0x{:03x}", number);
    }
  }
}

TEST(Csr, HasItsNameFromTheTable) {
  EXPECT_EQ(csr::name(0x341), "mepc");
  EXPECT_EQ(csr::name(0xb07), "mhpmcounter7");
  EXPECT_EQ(csr::name(0xc9f), "hpmcounter31h");
  EXPECT_EQ(csr::name(0x7b5), "lpend1");
  EXPECT_EQ(csr::name(0x7c0), "csr0x7c0");
  for (const auto& named : csr::named()) EXPECT_EQ(csr::name(named.number), named.name);
}

TEST(Counter, CanBeSetStoppedAndReadForInstructions) {
  Machine machine(fmt::format(R"(
_start: li t0, 100
    csrw minstret, t0
    csrr s2, minstret
    csrwi mcountinhibit, 5
    csrr s3, minstret
    nop
    nop
    csrr s4, minstret
    csrr s5, mcycle
    csrr s6, mcycle
    csrwi mcountinhibit, 0
    csrr s7, minstret
    csrr s8, minstreth
    csrr s9, instret
    {}
)",
                              kEnd));
  ASSERT_EQ(machine.run(), Stop::watch);
  EXPECT_EQ(machine.reg(18), 100U) << "a write replaces its own increment";
  EXPECT_EQ(machine.reg(19), machine.reg(20)) << "stands still";
  EXPECT_EQ(machine.reg(21), machine.reg(22));
  EXPECT_EQ(machine.reg(23), machine.reg(19) + 1) << "continues at its value, from the write that enabled it";
  EXPECT_EQ(machine.reg(24), 0U);
  EXPECT_EQ(machine.reg(25), machine.reg(23) + 2);
}

TEST(Code, RunsAsWrittenAfterAStore) {
  // The loop body changes from "addi a0, a0, 1" to "addi a0, a0, 16" after its first iteration.
  Machine machine(fmt::format(R"(
_start: .option norvc
    la s0, body
    li s1, 0x01050513
    li s2, 3
body: addi a0, a0, 1
    sw s1, 0(s0)
    fence.i
    addi s2, s2, -1
    bnez s2, body
    {}
)",
                              kEnd));
  ASSERT_EQ(machine.run(), Stop::watch);
  EXPECT_EQ(machine.reg(10), 1U + 16 + 16);
}

TEST(Code, RunsAsWrittenAfterAStoreIntoTheNextInstruction) {
  Machine machine(fmt::format(
      "_start: .option norvc\nla s0, next\nli s1, 0x01050513\nsw s1, 0(s0)\nnext: addi a0, a0, 1\n{}", kEnd));
  ASSERT_EQ(machine.run(), Stop::watch);
  EXPECT_EQ(machine.reg(10), 16U);
}

TEST(Code, LargerThanTheBlockCacheRuns) {
  // 80000 instructions do not fit into a segment of the decode cache.
  Machine machine(
      fmt::format("_start: li s0, 2\n2: .option norvc\n.rept 80000\naddi a0, a0, 1\n.endr\naddi s0, s0, -1\n"
                  "beqz s0, 3f\nla t0, 2b\njr t0\n3: {}",
                  kEnd));
  ASSERT_EQ(machine.run(), Stop::watch);
  EXPECT_EQ(machine.reg(10), 160000U);
}

/// Returns a program of about 22,500 instructions. It calls 1500 functions `turns` times. Each function contains a
/// branch, an if with else, and a loop.
std::string branchy_program(int turns) {
  return fmt::format(R"(
_start: .option norvc
    li s0, {}
again:
    .set n, 0
    .rept 1500
    jal ra, function + 56 * n
    .set n, n + 1
    .endr
    addi s0, s0, -1
    beqz s0, done
    la t0, again
    jr t0
function:
    .rept 1500
    andi t1, a0, 1
    beqz t1, 1f
    addi a0, a0, 3
1:  addi a0, a0, 5
    andi t1, a0, 2
    bnez t1, 2f
    addi a0, a0, 7
    j 3f
2:  xori a0, a0, 13
3:  andi t1, a0, 3
4:  addi t1, t1, -1
    addi a1, a1, 1
    bgtz t1, 4b
    ret
    .endr
done: {})",
                     turns, kEnd);
}

TEST(Code, IsDecodedAndTranslatedAtMostTwice) {
  Machine machine(branchy_program(300));
  ASSERT_EQ(machine.run(1'000'000'000), Stop::watch);
  constexpr std::uint64_t kInstructions = 1500 * (14 + 1) + 10;
  EXPECT_LE(machine.hart().code().blocks.decoded(), 2 * kInstructions);
  EXPECT_LE(machine.hart().code().instructions_translated(), 2 * kInstructions);
  if (translate::can_translate()) {
    EXPECT_GT(machine.hart().code().instructions_translated(), kInstructions / 2);
  }
}

TEST(Code, StaysDecodedWhenOtherCodeChanges) {
  // Runs 200 functions many times, and changes one of them before each time.
  Machine machine(fmt::format(R"(
_start: .option norvc
    li s0, 500
    la s1, changed
    lw s2, 0(s1)
    li s3, 0x00100000
again:
    xor s2, s2, s3
    sw s2, 0(s1)
    jal ra, changed
    .set n, 0
    .rept 200
    jal ra, function + 12 * n
    .set n, n + 1
    .endr
    addi s0, s0, -1
    bnez s0, again
    j done
changed: addi a0, a0, 1
    ret
    .balign 4
function:
    .rept 200
    addi a1, a1, 1
    addi a1, a1, 1
    ret
    .endr
done: {})",
                              kEnd));
  ASSERT_EQ(machine.run(1'000'000'000), Stop::watch);
  EXPECT_EQ(machine.reg(10), 250U) << "0 and 1 by turns";
  EXPECT_EQ(machine.reg(11), 500U * 200 * 2);
  EXPECT_LE(machine.hart().code().blocks.decoded(), 2U * (200 * 4 + 30) + 500 * 2 * 2);
}

TEST(Memory, WorksInTheSecondRegionAsInTheFirst) {
  Machine machine(
      fmt::format("_start: li s0, 0x70000ffc\nli a0, 0x12345678\nsw a0, 0(s0)\nlw a1, 0(s0)\nlbu a2, 3(s0)\n"
                  "sb a0, 3(s0)\nlw a3, 0(s0)\n{}",
                  kEnd));
  ASSERT_EQ(machine.run(), Stop::watch);
  EXPECT_EQ(machine.reg(11), 0x12345678U);
  EXPECT_EQ(machine.reg(12), 0x12U);
  EXPECT_EQ(machine.reg(13), 0x78345678U);
}

TEST(Run, EndsAtTheStoreIntoTohost) {
  Machine machine(
      "_start: la t0, tohost\nli a0, 3\nsw a0, 0(t0)\nli a0, 4\n1: j 1b\n.data\n.globl tohost\ntohost: .word 0, 0\n");
  ASSERT_EQ(machine.run(), Stop::watch);
  EXPECT_EQ(machine.reg(10), 3U) << "nothing later is executed";
}

/// Compares an uninterrupted run with runs that stop at a limit again and again. If the limits are close to each other,
/// most instructions are executed one by one instead of in blocks.
void expect_the_same_in_pieces(const Elf& program, CoreKind kind) {
  Machine straight(program, kind);
  ASSERT_EQ(straight.run(), Stop::watch);
  for (const std::uint64_t piece : {1U, 2U, 3U, 5U, 7U, 64U, 1000U}) {
    Machine split(program, kind);
    std::uint64_t limit = 0;
    Stop stop = Stop::limit;
    while (stop == Stop::limit) stop = split.run(limit += piece);
    EXPECT_EQ(stop, Stop::watch);
    EXPECT_EQ(split.hart().counters().cycles, straight.hart().counters().cycles) << "pieces of " << piece;
    EXPECT_EQ(split.hart().counters().instructions, straight.hart().counters().instructions);
    EXPECT_EQ(split.hart().counters().accesses, straight.hart().counters().accesses);
    for (unsigned i = 0; i < 32; ++i) EXPECT_EQ(split.reg(i), straight.reg(i)) << register_name(i);
  }
}

TEST(Run, CountsTheSameForAllSplits) {
  // The code contains every kind of delay. A jump overlaps with a misaligned load directly before it, also if a piece
  // of the run ends between the two.
  const auto program = assemble(fmt::format(R"(
_start: la s0, data
    li s1, 40
2:  lw a0, 0(s0)
    addi a0, a0, 3
    sw a0, 2(s0)
    lw a1, 2(s0)
    div a2, a0, s1
    jal helper
    mulh a3, a0, a0
    j 3f
    nop
3:  la t0, pointer
    lw t1, 0(t0)
    jalr t1
    lh a4, 3(s0)
    beqz a4, 4f
    c.nop
4:  addi s1, s1, -1
    lw a5, 1(s0)
    addi a6, a6, 1
    lw a7, 2(s0)
    jal helper
    addi a6, a6, 1
    lw a7, 3(s0)
    j 5f
    nop
5:  bnez s1, 2b
    csrr s2, mcycle
    csrr s3, minstret
    {}
helper: sw ra, 8(s0)
    lw ra, 8(s0)
    ret
    .data
    .balign 4
pointer: .word helper
data: .word 77, 0, 0, 0, 0, 0
)",
                                            kEnd));
  for (const auto kind : {CoreKind::cv32e40p, CoreKind::ri5cy}) expect_the_same_in_pieces(program, kind);
}

TEST(Run, InPiecesFollowsChangedCodeAndLoopEnds) {
  // Every second iteration stores an instruction over `patch`. From the fourth of eight iterations on, a hardware loop
  // ends at `last`.
  const auto program = assemble(fmt::format(R"(
_start: .option norvc
    la s0, patch
    la s1, words
    la s2, body
    la s3, last
    li s4, 8
    csrw 0x7b0, s2
turn: li t0, 5
    bgt s4, t0, no_loop
    csrw 0x7b1, s3
    csrwi 0x7b2, 3
no_loop: andi t1, s4, 1
    bnez t1, body
    andi t1, s4, 4
    add t1, t1, s1
    lw t2, 0(t1)
    sw t2, 0(s0)
body: addi a0, a0, 1
    add a1, a1, a0
last: xor a2, a2, a1
    addi a3, a3, 1
patch: addi a4, a4, 1
    addi s4, s4, -1
    bnez s4, turn
    {}
words: addi a4, a4, 16
    addi a4, a4, 64
)",
                                            kEnd));
  Machine machine(program, CoreKind::ri5cy);
  ASSERT_EQ(machine.run(), Stop::watch);
  EXPECT_EQ(machine.reg(10), 3U + 5 * 3) << "the loop was taken from the fourth turn on";
  EXPECT_EQ(machine.reg(14), 2U * (16 + 16 + 64 + 64)) << "each word ran in two turns of four";
  expect_the_same_in_pieces(program, CoreKind::ri5cy);
}

TEST(Run, DropsTheCutBlockWhenCodeOrPipelineChange) {
  constexpr std::string_view kProgram = R"(
_start: .option norvc
    la s0, _start
    addi a0, a0, 1
    addi a0, a0, 1
    lw a1, 0(s0)
    add a2, a2, a1
    addi a0, a0, 1
1:  j 1b
)";
  Machine stored(kProgram);
  EXPECT_EQ(stored.run(3), Stop::limit);
  EXPECT_EQ(stored.reg(10), 1U);
  const std::array<std::uint8_t, 4> addi_16{0x13, 0x05, 0x05, 0x01};
  ASSERT_TRUE(stored.memory().write(stored.hart().pc(), addi_16));
  stored.memory().changed(stored.hart().pc(), 4);
  EXPECT_EQ(stored.run(4), Stop::limit);
  EXPECT_EQ(stored.reg(10), 17U) << "the word that was stored over";

  for (const bool moved : {false, true}) {
    Machine machine(kProgram);
    EXPECT_EQ(machine.run(5), Stop::limit) << "after the load";
    if (moved) machine.hart().set_pc(machine.hart().pc());  // as a debugger does, long after the load
    EXPECT_EQ(machine.run(6), Stop::limit);
    EXPECT_EQ(machine.hart().counters().cycles, moved ? 6U : 7U);
  }
}

TEST(Run, StartsNoInstructionAtOrAfterTheLimit) {
  Machine machine("_start: .option norvc\n.rept 100\naddi a0, a0, 1\n.endr\n1: j 1b\n");
  EXPECT_EQ(machine.run(37), Stop::limit);
  EXPECT_EQ(machine.reg(10), 37U);
  EXPECT_EQ(machine.run(38), Stop::limit);
  EXPECT_EQ(machine.reg(10), 38U);
}

}  // namespace
}  // namespace mebots::soc::test
