// SPDX-License-Identifier: Apache-2.0
// Tests the cycles of each class of instructions against the table in hart/timing.hpp and README.md.
#include "machine.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace mebots::soc::test {
namespace {

constexpr int kRepeats = 16;

struct Case {
  std::string name;
  std::string body;  // instructions of one repetition
  double cycles;     // cycles of one repetition
};

/// Returns the cycles of one repetition of `body`: the mean of kRepeats repetitions between two reads of mcycle.
double cycles_of(const std::string& body, CoreKind kind) {
  const auto program = fmt::format(R"(
_start: .option norvc
    csrwi mcountinhibit, 0
    la a0, buffer
    la sp, buffer+256
    sw a0, 0(a0)
    li t3, 0x40000000
    li t4, 7
    j start
    .balign 16
f_ret: ret
    .balign 16
f_load: sw ra, 16(a0)
    lw ra, 16(a0)
    ret
    .balign 16
f_load_gap: sw ra, 16(a0)
    lw ra, 16(a0)
    nop
    ret
    .balign 16
f_mul: mul ra, ra, t5
    ret
    .balign 16
f_mulh: mulh t0, t1, t2
    ret
    .balign 64
start: li t5, 1
    csrr s1, mcycle
    .balign 16
    .rept {}
    {}
    .endr
    csrr s2, mcycle
    {}
    .data
    .balign 64
buffer: .space 1024
)",
                                   kRepeats, body, kEnd);
  Machine machine(program, kind);
  EXPECT_EQ(machine.run(), Stop::watch) << body;
  const int first_read = kind == CoreKind::ri5cy ? 1 : 4;
  const int padding = 2;  // number of nops up to the next multiple of 16 bytes
  return (static_cast<double>(machine.reg(18) - machine.reg(9)) - first_read - padding) / kRepeats;
}

const std::vector<Case> kBoth{
    {"alu", "addi t0, t0, 1", 1},
    {"mul", "mul t0, t0, t4", 1},
    {"mulh", "mulh t0, t1, t2", 5},
    {"mulhsu", "mulhsu t0, t0, t2", 5},
    {"mulhu", "mulhu t0, t1, t2", 5},
    {"divide by 0", "divu t0, t3, zero", 35},
    {"divide by 7", "div t0, t3, t4", 3 + 29},
    {"divide by 2^30", "remu t0, t4, t3", 3 + 1},
    {"divide by -1", "li t1, -1\ndiv t0, t3, t1", 1 + 34},
    {"divide by the smallest", "lui t1, 0x80000\nrem t0, t3, t1", 1 + 3},
    {"unsigned divide by 2^31", "lui t1, 0x80000\ndivu t0, t3, t1", 1 + 3},
    {"load and use", "lw t0, 4(a0)\naddi t1, t0, 1", 3},
    {"load, gap, use", "lw t0, 4(a0)\naddi t2, t3, 1\naddi t1, t0, 1", 3},
    {"load and store it", "lw t0, 4(a0)\nsw t0, 8(a0)", 3},
    {"load an address and store there", "lw a0, 0(a0)\nsw t3, 4(a0)", 3},
    {"load and overwrite", "lw t0, 4(a0)\nli t0, 5", 3},
    {"load and multiply", "lw t0, 4(a0)\nmul t1, t0, t0", 3},
    {"load and branch not taken", "lw t0, 4(a0)\nbne t0, t0, start", 3},
    {"load into zero and use zero", "lw zero, 4(a0)\naddi t1, zero, 1", 2},
    {"store", "sw t0, 4(a0)", 1},
    {"store then load", "sw t3, 4(a0)\nlw t0, 4(a0)", 2},
    {"misaligned store", "sw t0, 5(a0)", 2},
    {"misaligned half word inside a word", "sh t0, 5(a0)", 1},
    {"half word across words", "sh t0, 7(a0)", 2},
    {"misaligned load and use", "lw t0, 6(a0)\naddi t1, t0, 1", 4},
    {"branch not taken", "bne zero, zero, start", 1},
    {"branch taken", "beq zero, zero, 1f\nnop\n1:", 3},
    {"branch taken to the next", "beq zero, zero, 1f\n1:", 3},
    {"load and branch taken on it", "lw t0, 32(a0)\nbeq zero, zero, 1f\nnop\n1:", 4},
    {"branch taken to a 32-bit instruction at 2 mod 4",
     ".balign 4\nbeq zero, zero, 1f\n.option rvc\nc.nop\n.option norvc\n1: addi t0, t1, 1\n.option rvc\nc.nop\n.option "
     "norvc",
     4 + 1 + 1},
    {"branch taken to a 16-bit instruction at 2 mod 4",
     ".balign 4\nbeq zero, zero, 1f\n.option rvc\nc.nop\n1: c.nop\n.option norvc", 3 + 1},
    {"jump", "jal zero, 1f\nnop\n1:", 2},
    {"jump to a 32-bit instruction at 2 mod 4",
     ".balign 4\njal zero, 1f\n.option rvc\nc.nop\n.option norvc\n1: addi t0, t1, 1\n.option rvc\nc.nop\n.option norvc",
     3 + 1 + 1},
    {"jalr from an addition just before", "auipc t0, 0\njalr zero, 12(t0)\nnop", 1 + 3},
    {"jalr from an addition two before", "auipc t0, 0\naddi t2, t3, 1\njalr zero, 16(t0)\nnop", 1 + 1 + 2},
    {"call and return", "jal f_ret", 2 + 2},
    {"return from a load just before", "jal f_load", 2 + 1 + 1 + 4},
    {"return from a load two before", "jal f_load_gap", 2 + 1 + 1 + 1 + 3},
    {"return from a multiplication just before", "jal f_mul", 2 + 1 + 3},
    {"return hidden behind mulh", "jal f_mulh", 2 + 5 + 1},
    {"jump that overlaps with a division", "div t0, t4, t3\njal zero, 1f\nnop\n1:", 4 + 1},
    {"jump that overlaps with a misaligned load", "lw t0, 34(a0)\njal zero, 1f\nnop\n1:", 2 + 1},
    {"compressed", ".option rvc\nc.addi t0, 1\nc.addi t0, 1\n.option norvc", 2},
    {"mstatus", "csrr t0, mstatus", 4},
    {"mhartid", "csrr t0, mhartid", 1},
};

const std::vector<Case> kOnlyCv32e40p{
    {"loads in a row into one register", "lw t0, 4(a0)", 1},
    {"load, store with an offset like its register", "lw t0, 4(a0)\nsb t3, 5(a0)", 2},
    {"mepc", "csrr t0, mepc", 4},
    {"mcycle", "csrr t0, mcycle", 4},
    {"mscratch", "csrw mscratch, t0", 1},
    {"fence", "fence", 4},
    {"fence.i", "fence.i", 4},
};

const std::vector<Case> kOnlyRi5cy{
    {"load, store with an offset like its register", "lw t0, 4(a0)\nsb t3, 5(a0)", 3},
    {"mepc", "csrr t0, mepc", 1},
};

void expect_all(const std::vector<Case>& cases, CoreKind kind) {
  for (const auto& c : cases) EXPECT_EQ(cycles_of(c.body, kind), c.cycles) << c.name << ":\n" << c.body;
}

TEST(Timing, FollowsTheTableOfCv32e40p) {
  expect_all(kBoth, CoreKind::cv32e40p);
  expect_all(kOnlyCv32e40p, CoreKind::cv32e40p);
}

TEST(Timing, FollowsTheTableOfRi5cy) {
  expect_all(kBoth, CoreKind::ri5cy);
  expect_all(kOnlyRi5cy, CoreKind::ri5cy);
}

TEST(Timing, StallsALoadAfterALoadIntoTheSameRegisterOnRi5cyOnly) {
  // 16 consecutive loads into one register form 15 pairs, each of which stalls for one cycle.
  EXPECT_EQ(cycles_of("lw t0, 4(a0)", CoreKind::ri5cy) * kRepeats, 16 + 15);
  EXPECT_EQ(cycles_of("lw t0, 4(a0)\nlw t1, 4(a0)", CoreKind::ri5cy), 2);
}

TEST(Timing, IsNineCyclesForEcallAndMret) {
  Machine machine(fmt::format(R"(
_start: .option norvc
    la t0, handler
    csrw mtvec, t0
    csrwi mcountinhibit, 0
    j go
    .balign 64
go: csrr s1, mcycle
    .rept 16
    ecall
    .endr
    csrr s2, mcycle
    {}
    .balign 256
handler: csrr t5, mepc
    addi t5, t5, 4
    csrw mepc, t5
    mret
)",
                              kEnd),
                  CoreKind::cv32e40p);
  ASSERT_EQ(machine.run(), Stop::watch);
  EXPECT_EQ((machine.reg(18) - machine.reg(9) - 4) / 16, 9U + 4 + 1 + 4);
}

}  // namespace
}  // namespace mebots::soc::test
