// SPDX-License-Identifier: Apache-2.0
// Tests Xpulp v2 with examples that were calculated by hand from the RI5CY user manual, and with special cases of
// hardware loops. Because Debian's assembler does not know Xpulp, the words are encoded by .insn with the numbers of
// the manual's tables.
#include "hart/observer.hpp"
#include "machine.hpp"
#include "mebots/state/save.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

namespace mebots::soc::test {
namespace {

/// Defines instructions as macros. `last` of a hardware loop is the distance in bytes from the loop instruction to the
/// last instruction of the loop's body.
constexpr std::string_view kMacros = R"(
    .option norvc
    .macro lp_starti l, first
    .insn i 0x7b, 0, x\l, x0, (\first) / 2
    .endm
    .macro lp_endi l, last
    .insn i 0x7b, 1, x\l, x0, (\last) / 2
    .endm
    .macro lp_count l, rs
    .insn i 0x7b, 2, x\l, \rs, 0
    .endm
    .macro lp_counti l, n
    .insn i 0x7b, 3, x\l, x0, \n
    .endm
    .macro lp_setup l, rs, last
    .insn i 0x7b, 4, x\l, \rs, (\last) / 2
    .endm
    .macro lp_setupi l, n, last
    .word 0x7b | 5 << 12 | \l << 7 | ((\last) / 2) << 15 | (\n) << 20
    .endm
    .macro branch_imm f3, rs, value         # over one instruction; rs: a number
    .word 0x63 | \f3 << 12 | \rs << 15 | (\value & 31) << 20 | 8 << 7
    .endm
    .macro alu f7, f3, rd, a, b
    .insn r 0x33, \f3, \f7, \rd, \a, \b
    .endm
    .macro simd f7, f3, rd, a, b
    .insn r 0x57, \f3, \f7, \rd, \a, \b
    .endm
)";

std::string program(std::string_view body) {
  return fmt::format("{}\n_start:\n{}\n{}", kMacros, body, kEnd);
}

Elf assembled(std::string_view body) {
  return assemble(program(body));
}
Machine finished(std::string_view body) {
  return Machine(assembled(body), CoreKind::ri5cy);
}

struct Example {
  const char* instruction;
  std::uint32_t a;
  std::uint32_t b;
  std::uint32_t into;  // value of rd before the instruction
  std::uint32_t result;
};

/// Executes all operations in one program, and compares the results. Operand a is in a1, b in a2, and rd is a0.
void expect_examples(const std::vector<Example>& examples) {
  std::string body = "la s0, results\n";
  for (const auto& example : examples) {
    body += fmt::format("li a1, {}\nli a2, {}\nli a0, {}\n{}\nsw a0, 0(s0)\naddi s0, s0, 4\n",
                        static_cast<std::int32_t>(example.a), static_cast<std::int32_t>(example.b),
                        static_cast<std::int32_t>(example.into), example.instruction);
  }
  auto machine = finished(fmt::format("{}.data\n.balign 4\nresults: .space {}\n.text\n", body, 4 * examples.size()));
  ASSERT_EQ(machine.run(), Stop::watch);
  for (std::size_t i = 0; i < examples.size(); ++i) {
    const auto result = machine.word("results", static_cast<std::uint32_t>(i));
    EXPECT_EQ(result, examples[i].result) << examples[i].instruction << fmt::format(" of 0x{:08x}", examples[i].a);
  }
}

TEST(Xpulp, GeneralAluComputesAsInTheManual) {
  expect_examples({
      {"alu 0x02, 0, a0, a1, x0", 0xfffffffb, 0, 0, 5},           // p.abs
      {"alu 0x02, 2, a0, a1, a2", 0xffffffff, 0xffffffff, 0, 1},  // p.slet
      {"alu 0x02, 3, a0, a1, a2", 0xffffffff, 1, 0, 0},           // p.sletu
      {"alu 0x02, 4, a0, a1, a2", 0xffffffff, 1, 0, 0xffffffff},  // p.min
      {"alu 0x02, 5, a0, a1, a2", 0xffffffff, 1, 0, 1},           // p.minu
      {"alu 0x02, 6, a0, a1, a2", 0xffffffff, 1, 0, 1},           // p.max
      {"alu 0x02, 7, a0, a1, a2", 0xffffffff, 1, 0, 0xffffffff},  // p.maxu
      {"alu 0x08, 4, a0, a1, x0", 0x12348001, 0, 0, 0xffff8001},  // p.exths
      {"alu 0x08, 5, a0, a1, x0", 0x12348001, 0, 0, 0x00008001},  // p.exthz
      {"alu 0x08, 6, a0, a1, x0", 0x12348081, 0, 0, 0xffffff81},  // p.extbs
      {"alu 0x08, 7, a0, a1, x0", 0x12348081, 0, 0, 0x00000081},  // p.extbz
      {"alu 0x0a, 1, a0, a1, x8", 300, 0, 0, 127},                // p.clip to 8 bits
      {"alu 0x0a, 1, a0, a1, x8", 0xfffffed4, 0, 0, 0xffffff80},  // -300
      {"alu 0x0a, 1, a0, a1, x0", 0xfffffed4, 0, 0, 0xffffffff},  // to 0 bits: -1 to 0
      {"alu 0x0a, 2, a0, a1, x9", 300, 0, 0, 255},                // p.clipu
      {"alu 0x0a, 2, a0, a1, x9", 0xfffffed4, 0, 0, 0},
      {"alu 0x0a, 5, a0, a1, a2", 300, 100, 0, 100},                // p.clipr
      {"alu 0x0a, 5, a0, a1, a2", 0xfffffed4, 100, 0, 0xffffff9b},  // -101
      {"alu 0x0a, 6, a0, a1, a2", 300, 100, 0, 100},                // p.clipur
      {"alu 0x21, 0, a0, a1, a2", 3, 0xfffffffc, 100, 88},          // p.mac
      {"alu 0x21, 1, a0, a1, a2", 3, 0xfffffffc, 100, 112},         // p.msu
  });
}

TEST(Xpulp, BitManipulationComputesAsInTheManual) {
  expect_examples({
      {"alu 0x60 + 7, 0, a0, a1, x4", 0x00000f80, 0, 0, 0xfffffff8},           // p.extract 8 bits from 4
      {"alu 0x60 + 7, 1, a0, a1, x4", 0x00000f80, 0, 0, 0x000000f8},           // p.extractu
      {"alu 0x40, 0, a0, a1, a2", 0x00000f80, 7 << 5 | 4, 0, 0xfffffff8},      // p.extractr
      {"alu 0x60 + 7, 2, a0, a1, x4", 0x123456ab, 0, 0xffffffff, 0xfffffabf},  // p.insert
      {"alu 0x60 + 7, 3, a0, a1, x4", 0xffffffff, 0, 0, 0xfffff00f},           // p.bclr
      {"alu 0x60 + 7, 4, a0, a1, x4", 0, 0, 0, 0x00000ff0},                    // p.bset
      {"alu 0x08, 0, a0, a1, x0", 0x00010800, 0, 0, 11},                       // p.ff1
      {"alu 0x08, 0, a0, a1, x0", 0, 0, 0, 32},
      {"alu 0x08, 1, a0, a1, x0", 0x00010800, 0, 0, 16},  // p.fl1
      {"alu 0x08, 2, a0, a1, x0", 0xffff0000, 0, 0, 15},  // p.clb
      {"alu 0x08, 2, a0, a1, x0", 0, 0, 0, 0},
      {"alu 0x08, 3, a0, a1, x0", 0xf0f0f0f1, 0, 0, 17},          // p.cnt
      {"alu 0x04, 5, a0, a1, a2", 0x12345678, 8, 0, 0x78123456},  // p.ror
  });
}

TEST(Xpulp, NormalisedArithmeticComputesAsInTheManual) {
  expect_examples({
      {".insn r 0x5b, 2, 0x00 + 1, a0, a1, a2", 5, 2, 0, 3},                             // p.addN
      {".insn r 0x5b, 6, 0x00 + 1, a0, a1, a2", 5, 2, 0, 4},                             // p.addRN
      {".insn r 0x5b, 2, 0x40 + 1, a0, a1, a2", 0xfffffffb, 0xfffffffe, 0, 0x7ffffffc},  // p.adduN
      {".insn r 0x5b, 3, 0x00 + 2, a0, a1, a2", 1, 10, 0, 0xfffffffd},                   // p.subN: -9 >> 2
      {".insn r 0x5b, 7, 0x00 + 2, a0, a1, a2", 1, 10, 0, 0xfffffffe},                   // p.subRN
      {".insn r 0x5b, 2, 0x20, a0, a1, a2", 2, 1, 5, 3},                                 // p.addNr: (5 + 2) >> 1
      {".insn r 0x5b, 7, 0x20, a0, a1, a2", 2, 1, 5, 2},                                 // p.subRNr: (5 - 2 + 1) >> 1
      {".insn r 0x5b, 0, 0x40, a0, a1, a2", 0x0002ffff, 0x00030004, 0, 0xfffffffc},      // p.muls
      {".insn r 0x5b, 0, 0x60, a0, a1, a2", 0x0002ffff, 0x00030004, 0, 6},               // p.mulhhs
      {".insn r 0x5b, 0, 0x00, a0, a1, a2", 0x0002ffff, 0x00030004, 0, 0x0003fffc},      // p.mulu
      {".insn r 0x5b, 4, 0x40 + 2, a0, a1, a2", 3, 2, 0, 2},                             // p.mulsRN: (6 + 2) >> 2
      {".insn r 0x5b, 1, 0x40 + 1, a0, a1, a2", 3, 5, 4, 9},                             // p.macsN: (4 + 15) >> 1
      {".insn r 0x5b, 5, 0x60 + 1, a0, a1, a2", 0x30000, 0x50000, 4, 10},                // p.machhsRN
  });
}

TEST(Xpulp, SimdComputesAsInTheManual) {
  expect_examples({
      {"simd 0x00, 0, a0, a1, a2", 0x7fff0001, 0x00010002, 0, 0x80000003},           // pv.add.h
      {"simd 0x00, 5, a0, a1, a2", 0x01020304, 0x99999910, 0, 0x11121314},           // pv.add.sc.b
      {"simd 0x00, 6, a0, a1, x31", 0x00050006, 0, 0, 0x00030004},                   // pv.add.sci.h -2
      {"simd 0x04, 1, a0, a1, a2", 0x01020304, 0x02020202, 0, 0xff000102},           // pv.sub.b
      {"simd 0x08, 0, a0, a1, a2", 0xfffd0004, 0x00000002, 0, 0xfffe0003},           // pv.avg.h
      {"simd 0x0c, 1, a0, a1, a2", 0x80020406, 0x60020202, 0, 0x70020304},           // pv.avgu.b
      {"simd 0x10, 1, a0, a1, a2", 0x80017f05, 0x00000000, 0, 0x80000000},           // pv.min.b
      {"simd 0x1c, 4, a0, a1, a2", 0x80010001, 0x11110100, 0, 0x80010100},           // pv.maxu.sc.h
      {"simd 0x24, 4, a0, a1, a2", 0x8000ff00, 4, 0, 0xf800fff0},                    // pv.sra.sc.h
      {"simd 0x28, 1, a0, a1, a2", 0x01020304, 0x01020304, 0, 0x02081840},           // pv.sll.b
      {"simd 0x38, 1, a0, a1, x0", 0x80ff7f01, 0, 0, 0x80017f01},                    // pv.abs.b
      {"simd 0x38, 1, a0, a1, a2", 0x80ff7f01, 7, 0, 0x80017f01},                    // rs2 has no effect
      {"simd 0x3c, 7, a0, a1, x1", 0x12845678, 0, 0, 0xffffff84},                    // pv.extract.b part 2
      {"simd 0x49, 6, a0, a1, x0", 0x92345678, 0, 0, 0x00009234},                    // pv.extractu.h part 1
      {"simd 0x58, 7, a0, a1, x1", 0x123456ab, 0, 0x11111111, 0x11ab1111},           // pv.insert.b part 2
      {"simd 0x02, 0, a0, a1, a2", 0x00010002, 0x00010003, 0, 0xffff0000},           // pv.cmpeq.h
      {"simd 0x22, 1, a0, a1, a2", 0x01ff0180, 0x02020101, 0, 0xff000000},           // pv.cmpltu.b
      {"simd 0x4c, 1, a0, a1, a2", 0x01ff02fe, 0x02020202, 0, 0},                    // pv.dotsp.b: 2 - 2 + 4 - 4
      {"simd 0x40, 1, a0, a1, a2", 0x01ff02fe, 0x02020202, 0, 1024},                 // pv.dotup.b
      {"simd 0x54, 0, a0, a1, a2", 0x0001ffff, 0xffffffff, 7, 0xffff0007},           // pv.sdotusp.h
      {"simd 0x5c, 7, a0, a1, x31", 0x01010101, 0, 10, 2},                           // pv.sdotsp.sci.b -2
      {"simd 0x60, 1, a0, a1, a2", 0x44332211, 0x00010203, 0, 0x11223344},           // pv.shuffle.b
      {"simd 0x79, 7, a0, a1, x13", 0x44332211, 0, 0, 0x33223344},                   // pv.shuffleI2.sci.b: 2; 1, 2, 3
      {"simd 0x64, 1, a0, a1, a2", 0x44332211, 0x07050200, 0x88776655, 0x44227755},  // pv.shuffle2.b
      {"simd 0x68, 0, a0, a1, a2", 0x11112222, 0x33334444, 0, 0x22224444},           // pv.pack
      {"simd 0x68, 4, a0, a1, a2", 0x11112222, 0x33334444, 0, 0x22224444},           // pv.pack.h.l
      {"simd 0x68, 6, a0, a1, a2", 0x11112222, 0x33334444, 0, 0x11113333},           // pv.pack.h.h
      {"simd 0x6c, 1, a0, a1, a2", 0x11, 0x22, 0x99998888, 0x11228888},              // pv.packhi.b
      {"simd 0x70, 1, a0, a1, a2", 0x11, 0x22, 0x99998888, 0x99991122},              // pv.packlo.b
  });
}

TEST(Xpulp, PostIncrementMovesThePointerAfterTheAccess) {
  auto machine = finished(R"(
    la a1, data
    mv a4, a1
    .insn i 0x0b, 2, a2, a1, 4            # p.lw a2, 4(a1!)
    .insn i 0x0b, 5, a3, a1, -2           # p.lhu a3, -2(a1!)
    sub a5, a1, a4
    li t0, 6
    .insn r 0x0b, 7, 0x00, a6, a4, t0     # p.lb a6, t0(a4!)
    .insn r 0x03, 7, 0x10, a7, a4, t1     # p.lw a7, t1(a4), t1 = 0
    la s0, room
    mv s1, s0
    .insn s 0x2b, 1, a3, 2(s0)            # p.sh a3, 2(s0!)
    .insn r 0x2b, 4, 0x00, t0, s0, a6     # p.sb a6, t0(s0!)
    .insn r 0x23, 6, 0x00, t0, s1, a2     # p.sw a2, t0(s1)
    sub s0, s0, s1
    la s2, data
    .insn i 0x0b, 2, s2, s2, 4            # the load wins
    .data
    .balign 4
data: .word 0x818283f4, 0x85868788, 0x898a8b8c
room: .word 0, 0, 0, 0
    .text
  )");
  ASSERT_EQ(machine.run(), Stop::watch);
  EXPECT_EQ(machine.reg(12), 0x818283f4U);
  EXPECT_EQ(machine.reg(13), 0x8788U);
  EXPECT_EQ(machine.reg(15), 2U);
  EXPECT_EQ(machine.reg(16), 0xfffffff4U);
  EXPECT_EQ(machine.reg(17), 0x8b8c8586U);
  EXPECT_EQ(machine.word("room"), 0x00f48788U);
  EXPECT_EQ(machine.word("room", 1), 0x83f40000U);
  EXPECT_EQ(machine.word("room", 2), 0x00008182U);
  EXPECT_EQ(machine.reg(8), 8U);
  EXPECT_EQ(machine.reg(18), 0x818283f4U);
}

/// With an observer, each instruction is decoded alone, and its cycles depend on the stored pipeline state. Without an
/// observer, instructions are decoded in blocks.
TEST(Xpulp, JumpAfterAMisalignedLoadTakesTheSameTimeWithAnObserver) {
  // t4 points to the jump's target; p.lw a3, 0(t4!) writes it, too.
  constexpr std::string_view kLoads[] = {".insn i 0x0b, 2, a3, t4, 0", "lw a3, 0(t4)", "lw ra, 0(t4)"};
  constexpr std::string_view kJumps[] = {"jalr ra, 0(t4)", "jalr ra, 0(t5)", "jalr a3, 0(t5)", "j there",
                                         "jal a3, there"};
  for (const auto load : kLoads) {
    for (const auto jump : kJumps) {
      for (const auto place : {"", ".2byte 1"}) {
        const auto elf = assembled(fmt::format(R"(
    la t4, there
    mv t5, t4
    j 1f
    .p2align 4
1:  nop
    {}
    {}
    .p2align 2
    {}
there: nop
    .p2align 2
)",
                                               load, jump, place));
        Machine plain(elf, CoreKind::ri5cy);
        Machine watched(elf, CoreKind::ri5cy);
        Observer observer;
        watched.hart().observe(&observer);
        ASSERT_EQ(plain.run(), Stop::watch) << load << "; " << jump;
        ASSERT_EQ(watched.run(), Stop::watch);
        EXPECT_EQ(plain.hart().counters().cycles, watched.hart().counters().cycles)
            << load << "; " << jump << ", " << place;
      }
    }
  }
}

TEST(Xpulp, PostIncrementThatTrapsLeavesThePointer) {
  auto machine = finished(R"(
    la t0, handler
    csrw mtvec, t0
    li a1, 0x1000
    .insn i 0x0b, 2, a2, a1, 4
    .balign 4
handler:
    csrr a3, mcause
  )");
  ASSERT_EQ(machine.run(), Stop::watch);
  EXPECT_EQ(machine.reg(11), 0x1000U);
  EXPECT_EQ(machine.reg(13), 5U);
}

TEST(Xpulp, ImmediateBranchesCompareWithASignedNumber) {
  auto machine = finished(R"(
    li a0, 0
    li a1, -16
    branch_imm 2, 11, -16         # p.beqimm
    ori a0, a0, 1
    branch_imm 3, 11, 15          # p.bneimm
    ori a0, a0, 2
    branch_imm 2, 11, 15
    ori a0, a0, 4
  )");
  ASSERT_EQ(machine.run(), Stop::watch);
  EXPECT_EQ(machine.reg(10), 4U);
}

TEST(Xpulp, IsIllegalOnACoreWithoutIt) {
  for (const char* instruction : {"simd 0x5c, 1, a0, a1, a2", "lp_counti 0, 4", ".insn i 0x0b, 2, a2, a1, 4",
                                  "alu 0x02, 6, a0, a1, a2", "csrr a0, 0x7b0", "csrr a0, 0x780"}) {
    Machine machine(program(instruction), CoreKind::cv32e40p);
    EXPECT_EQ(machine.run(), Stop::fault) << instruction;
    EXPECT_EQ(machine.hart().fault().last.cause, 2U) << instruction;
    EXPECT_EQ(machine.hart().counters().instructions, 0U) << instruction;
  }
}

TEST(HardwareLoop, RunsItsBodyAsOftenAsItsCountSays) {
  for (const unsigned count : {0U, 1U, 2U, 3U, 1000U}) {
    auto machine = finished(fmt::format("li a1, {}\nlp_setup 0, a1, 8\naddi a0, a0, 1\naddi a2, a2, 2\n", count));
    ASSERT_EQ(machine.run(), Stop::watch);
    EXPECT_EQ(machine.reg(10), std::max(count, 1U)) << count;  // a body always runs at least once
    EXPECT_EQ(machine.reg(12), 2 * std::max(count, 1U)) << count;
  }
}

TEST(HardwareLoop, RepeatsABodyOfOneInstruction) {
  auto machine = finished("lp_setupi 1, 100, 4\naddi a0, a0, 3\n");
  ASSERT_EQ(machine.run(), Stop::watch);
  EXPECT_EQ(machine.reg(10), 300U);
}

TEST(HardwareLoop, IterationsCostNoCycles) {
  const auto cycles = [](unsigned count) {
    auto machine =
        finished(fmt::format("lp_setupi 0, {}, 12\naddi a0, a0, 1\nadd a1, a1, a0\nxor a2, a1, a0\n", count));
    EXPECT_EQ(machine.run(), Stop::watch);
    return machine.hart().counters().cycles;
  };
  EXPECT_EQ(cycles(101) - cycles(1), 300U);
}

TEST(HardwareLoop, LoadAtItsEndStallsItsStart) {
  const auto cycles = [](unsigned count) {
    auto machine = finished(
        fmt::format("la a3, tohost\nlp_setupi 0, {}, 12\nadd a1, a1, a0\nxor a2, a1, a2\nlw a0, 4(a3)\n", count));
    EXPECT_EQ(machine.run(), Stop::watch);
    return machine.hart().counters().cycles;
  };
  EXPECT_EQ(cycles(101) - cycles(1), 400U);
}

constexpr std::string_view kNested = R"(
    li a5, 7
    lp_setup 1, a5, 20
    addi a0, a0, 1
    lp_setupi 0, 5, 8
    addi a1, a1, 1
    addi a2, a2, 2
    addi a3, a3, 3
)";

TEST(HardwareLoop, NestsTwice) {
  auto machine = finished(kNested);
  ASSERT_EQ(machine.run(), Stop::watch);
  EXPECT_EQ(machine.reg(10), 7U);
  EXPECT_EQ(machine.reg(11), 35U);
  EXPECT_EQ(machine.reg(12), 70U);
  EXPECT_EQ(machine.reg(13), 21U);
}

TEST(HardwareLoop, BothMayEndAtOneInstruction) {
  auto machine = finished(R"(
    lp_setupi 1, 3, 12
    lp_counti 0, 4
    lp_setupi 0, 4, 4
    addi a0, a0, 1
  )");
  ASSERT_EQ(machine.run(), Stop::watch);
  EXPECT_EQ(machine.reg(10), 12U);
}

TEST(HardwareLoop, RegistersCanBeReadAndWrittenAsCsrs) {
  auto machine = finished(R"(
    li a1, 9
    lp_starti 1, 40
    lp_endi 1, 48
    lp_count 1, a1
    csrr a2, 0x7b4
    csrr a3, 0x7b5
    csrr a4, 0x7b6
    la a5, _start
    la t0, body
    la t1, last
    csrw 0x7b0, t0
    csrw 0x7b1, t1
    csrwi 0x7b2, 6
body:
    addi a0, a0, 1
last:
    addi s0, s0, 1
  )");
  ASSERT_EQ(machine.run(), Stop::watch);
  EXPECT_EQ(machine.reg(12) - machine.reg(15), 4U + 40U);
  EXPECT_EQ(machine.reg(13) - machine.reg(15), 8U + 48U);
  EXPECT_EQ(machine.reg(14), 9U);
  EXPECT_EQ(machine.reg(10), 6U);
  EXPECT_EQ(machine.reg(8), 6U);
}

TEST(HardwareLoop, EndMayMoveIntoDecodedCode) {
  // The function is first executed without a loop, and then as a loop's body with two different ends.
  auto machine = finished(R"(
    call f
    la t0, body
    csrw 0x7b0, t0
    la t0, one
    csrw 0x7b1, t0
    csrwi 0x7b2, 5
    call f
    la t0, two
    csrw 0x7b1, t0
    csrwi 0x7b2, 10
    call f
    j done
f:
body:
    addi a0, a0, 1
one:
    addi a1, a1, 1
two:
    addi a2, a2, 1
    ret
done:
  )");
  ASSERT_EQ(machine.run(), Stop::watch);
  EXPECT_EQ(machine.reg(10), 1U + 5U + 10U);
  EXPECT_EQ(machine.reg(11), 1U + 5U + 10U);
  EXPECT_EQ(machine.reg(12), 1U + 1U + 10U);
}

TEST(HardwareLoop, ContinuesAfterAStoreThatLeavesItsBlock) {
  // The last instruction of the loop stores into a word that is marked as code. Such a store ends the execution of its
  // block.
  auto machine = finished(R"(
    la a1, room
    li a2, 5
    lp_setupi 0, 6, 8
    addi a0, a0, 1
    sw a2, 0(a1)
    j 1f
room: .word 0
    nop
1:
  )");
  machine.memory().mark(*machine.program().symbol("room"), 4, Region::kCode);
  ASSERT_EQ(machine.run(), Stop::watch);
  EXPECT_EQ(machine.reg(10), 6U);
}

TEST(HardwareLoop, BodyThatIsWrittenOverRunsAsWritten) {
  auto machine = finished(R"(
    la t0, body
    la t1, other
    lw t1, 0(t1)
    jal ra, f
    sw t1, 0(t0)
    fence.i
    jal ra, f
    j done
f:
    lp_setupi 0, 10, 8
body:
    addi a0, a0, 1
    addi a1, a1, 1
    ret
other:
    addi a0, a0, 100
done:
  )");
  ASSERT_EQ(machine.run(), Stop::watch);
  EXPECT_EQ(machine.reg(10), 10U + 1000U);
  EXPECT_EQ(machine.reg(11), 20U);
}

constexpr std::string_view kInterrupted = R"(
    la t0, handler
    csrw mtvec, t0
    li t0, 0x80
    csrw mie, t0
    csrwi mstatus, 8
    j go
    .balign 4
handler:
    addi s0, s0, 1
    csrr s1, mepc
    csrw mie, zero
    mret
go:
)";

TEST(HardwareLoop, ContinuesAfterAnInterruptAtAnyInstruction) {
  const auto elf = assembled(fmt::format("{}{}", kInterrupted, kNested));
  Machine reference(elf, CoreKind::ri5cy);
  ASSERT_EQ(reference.run(), Stop::watch);
  const auto total = reference.hart().counters().cycles;
  std::uint32_t inside = 0;
  for (std::uint64_t cycle = 20; cycle + 20 < total; ++cycle) {
    Machine machine(elf, CoreKind::ri5cy);
    ASSERT_EQ(machine.run(cycle), Stop::limit);
    machine.hart().set_interrupt(7, true);
    ASSERT_EQ(machine.run(), Stop::watch);
    EXPECT_EQ(machine.reg(8), 1U);
    for (unsigned i = 10; i < 14; ++i) EXPECT_EQ(machine.reg(i), reference.reg(i)) << cycle;
    EXPECT_EQ(machine.hart().counters().instructions, reference.hart().counters().instructions + 4) << cycle;
    ++inside;
  }
  EXPECT_GT(inside, 50U);
}

TEST(HardwareLoop, CountsTheSameWhenItIsStoppedAtEveryCycle) {
  auto whole = finished(kNested);
  ASSERT_EQ(whole.run(), Stop::watch);
  auto pieces = finished(kNested);
  std::uint64_t limit = 1;
  while (pieces.run(limit) == Stop::limit) ++limit;
  EXPECT_EQ(pieces.hart().counters().cycles, whole.hart().counters().cycles);
  EXPECT_EQ(pieces.hart().counters().instructions, whole.hart().counters().instructions);
  EXPECT_EQ(pieces.reg(11), 35U);
}

/// The cycles of a jump after a loop's end depend on the last instructions of the body. Single instructions, blocks and
/// translated code must give the same cycles.
TEST(HardwareLoop, JumpDirectlyAfterItTakesTheSameTimeInAllRuns) {
  constexpr std::string_view kLoops[] = {"lp_setupi 0, 3, 16\n nop\n", "lp_setupi 1, 2, 16\n lp_setupi 0, 2, 8\n"};
  constexpr std::string_view kBefore[] = {"nop", "lw t4, 0(s2)", "lw ra, 0(s2)"};
  constexpr std::string_view kLast[] = {
      "addi a0, a0, 1", "addi t4, t4, 0",  "lw t4, 0(s2)", "lw a0, 0(s2)", "lw a0, 0(s3)",  // s3: across two words
      "lw ra, 0(s2)",   "mulh a1, a1, a2", "sb a0, 4(s2)", "sw a0, 0(s3)", "div a1, a1, a2"};
  constexpr std::string_view kJumps[] = {"jr t4", "j there", "jal ra, there", "jalr ra, 0(t4)"};
  const auto expect_same_cycles = [](const Elf& elf, const std::string& of) {
    Machine translated(elf, CoreKind::ri5cy);
    Machine interpreted(elf, {.kind = CoreKind::ri5cy, .translate = false});
    Machine cut(elf, {.kind = CoreKind::ri5cy, .translate = false});
    ASSERT_EQ(translated.run(), Stop::watch);
    ASSERT_EQ(interpreted.run(), Stop::watch);
    for (std::uint64_t limit = 1; cut.run(limit) == Stop::limit;) ++limit;
    EXPECT_EQ(interpreted.hart().counters().cycles, cut.hart().counters().cycles) << of;
    EXPECT_EQ(translated.hart().counters().cycles, cut.hart().counters().cycles) << of;
    EXPECT_EQ(translated.reg(15), 0U) << "it jumps";
  };
  for (const auto loops : kLoops) {
    for (const auto before : kBefore) {
      for (const auto last : kLast) {
        for (const auto jump : kJumps) {
          // In every second iteration, a jump leads to the last instruction of the body. Then the loop does not end
          // there.
          const auto elf = assembled(fmt::format(R"(
    la s2, data
    addi s3, s2, 10
    la t4, there
    sw t4, 0(s2)
    li s1, 400
again: andi t0, s1, 1
    bnez t0, 1f
    lp_counti 0, 0
    lp_counti 1, 0
    j 2f
1:  {}
    addi a4, a4, 1
    {}
2:  {}
    {}
    addi a5, a5, 1
    .p2align 2
    .2byte 1
there: addi s1, s1, -1
    bnez s1, again
    .data
    .balign 4
data: .space 32
    .text
)",
                                                 loops, before, last, jump));
          expect_same_cycles(elf, fmt::format("{}{}; {}; {}", loops, before, last, jump));
        }
      }
    }
  }
}

TEST(HardwareLoop, ContinuesFromAStateSavedInsideIt) {
  const auto elf = assembled(kNested);
  Machine whole(elf, CoreKind::ri5cy);
  ASSERT_EQ(whole.run(), Stop::watch);
  const auto total = whole.hart().counters().cycles;
  for (std::uint64_t cycle = 1; cycle < total; cycle += 3) {
    Machine first(elf, CoreKind::ri5cy);
    ASSERT_EQ(first.run(cycle), Stop::limit);
    Machine second(elf, CoreKind::ri5cy);  // has not yet marked this code as a loop's end
    state::restore(second.hart(), state::save(first.hart()));
    ASSERT_EQ(second.run(), Stop::watch);
    EXPECT_EQ(second.hart().counters().cycles, total) << cycle;
    for (unsigned i = 10; i < 14; ++i) EXPECT_EQ(second.reg(i), whole.reg(i)) << cycle;
  }
}

TEST(EventCounter, CountsWhileEnabledWithoutItsOwnRead) {
  auto machine = finished(R"(
    csrr a0, 0x780
    csrwi 0x7a0, 3
    nop
    csrr a1, 0x781
    csrr a2, 0x781
    csrwi 0x7a1, 0
    nop
    nop
    csrr a3, 0x781
    csrw 0x781, a1
    csrr a4, 0x781
  )");
  ASSERT_EQ(machine.run(), Stop::watch);
  EXPECT_EQ(machine.reg(10), 0U);
  EXPECT_EQ(machine.reg(12), machine.reg(11));       // a read replaces its own count
  EXPECT_EQ(machine.reg(13), machine.reg(12) + 0U);  // so does the instruction that switches the counter off
  EXPECT_EQ(machine.reg(14), machine.reg(11));
}

}  // namespace
}  // namespace mebots::soc::test
