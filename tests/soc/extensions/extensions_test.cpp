// SPDX-License-Identifier: Apache-2.0
// Tests programs with the options of a core: A, F, Zfinx, Zba, Zbb, Zbc, Zbs. Expected values are computed by the
// definitions in the manual. Debian's assembler encodes the programs, so the tests also find wrong encodings.
#include "hart/csr_numbers.hpp"
#include "machine.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace mebots::soc::test {
namespace {

/// Runs a program on a core with the options of `isa`.
std::unique_ptr<Machine> run(const std::string& isa, const std::string& body) {
  const auto text = fmt::format("_start:\n{}\n{}", body, kEnd);
  const auto march = isa.find('u') == std::string::npos ? isa : std::string(isa).erase(isa.find('u'), 1);
  auto machine = std::make_unique<Machine>(
      Elf::parse(assemble_file(text, 0x80000000, "-march=" + march + " -mabi=ilp32"), "test program"),
      MachineSettings{.options = read_isa(isa)});
  machine->run();
  EXPECT_EQ(machine->word("tohost"), 1U) << body;
  return machine;
}

using Rule = std::function<std::uint32_t(std::uint32_t, std::uint32_t)>;

bool bit(std::uint32_t word, unsigned number) {
  return (word >> number & 1U) != 0;
}

std::uint32_t from_bits(const std::function<bool(unsigned)>& rule) {
  std::uint32_t word = 0;
  for (unsigned i = 0; i < 32; ++i) word |= rule(i) ? 1U << i : 0U;
  return word;
}

/// Returns bit `number` of the product of two polynomials over GF(2).
bool product_bit(std::uint32_t a, std::uint32_t b, unsigned number) {
  bool sum = false;
  for (unsigned i = 0; i < 32; ++i) {
    if (number >= i && number - i < 32) sum = sum != (bit(a, i) && bit(b, number - i));
  }
  return sum;
}

const std::map<std::string, Rule>& two_operands() {
  static const std::map<std::string, Rule> rules{
      {"sh1add", [](auto a, auto b) { return 2 * a + b; }},
      {"sh2add", [](auto a, auto b) { return 4 * a + b; }},
      {"sh3add", [](auto a, auto b) { return 8 * a + b; }},
      {"andn", [](auto a, auto b) { return from_bits([=](unsigned i) { return bit(a, i) && !bit(b, i); }); }},
      {"orn", [](auto a, auto b) { return from_bits([=](unsigned i) { return bit(a, i) || !bit(b, i); }); }},
      {"xnor", [](auto a, auto b) { return from_bits([=](unsigned i) { return bit(a, i) == bit(b, i); }); }},
      {"min", [](auto a, auto b) { return static_cast<int>(a) < static_cast<int>(b) ? a : b; }},
      {"max", [](auto a, auto b) { return static_cast<int>(a) < static_cast<int>(b) ? b : a; }},
      {"minu", [](auto a, auto b) { return a < b ? a : b; }},
      {"maxu", [](auto a, auto b) { return a < b ? b : a; }},
      {"rol", [](auto a, auto b) { return from_bits([=](unsigned i) { return bit(a, (i - b) % 32); }); }},
      {"ror", [](auto a, auto b) { return from_bits([=](unsigned i) { return bit(a, (i + b) % 32); }); }},
      {"clmul", [](auto a, auto b) { return from_bits([=](unsigned i) { return product_bit(a, b, i); }); }},
      {"clmulh", [](auto a, auto b) { return from_bits([=](unsigned i) { return product_bit(a, b, i + 32); }); }},
      {"clmulr", [](auto a, auto b) { return from_bits([=](unsigned i) { return product_bit(a, b, i + 31); }); }},
      {"bclr", [](auto a, auto b) { return from_bits([=](unsigned i) { return bit(a, i) && i != b % 32; }); }},
      {"bext", [](auto a, auto b) { return bit(a, b % 32) ? 1U : 0U; }},
      {"binv", [](auto a, auto b) { return from_bits([=](unsigned i) { return bit(a, i) != (i == b % 32); }); }},
      {"bset", [](auto a, auto b) { return from_bits([=](unsigned i) { return bit(a, i) || i == b % 32; }); }},
  };
  return rules;
}

const std::map<std::string, Rule>& one_operand() {
  const auto byte_of = [](std::uint32_t a, unsigned i) { return a >> (8 * i) & 0xffU; };
  static const std::map<std::string, Rule> rules{
      {"clz",
       [](auto a, auto) {
         std::uint32_t count = 0;
         while (count < 32 && !bit(a, 31 - count)) ++count;
         return count;
       }},
      {"ctz",
       [](auto a, auto) {
         std::uint32_t count = 0;
         while (count < 32 && !bit(a, count)) ++count;
         return count;
       }},
      {"cpop",
       [](auto a, auto) {
         std::uint32_t count = 0;
         for (unsigned i = 0; i < 32; ++i) count += bit(a, i) ? 1 : 0;
         return count;
       }},
      {"sext.b", [](auto a, auto) { return from_bits([=](unsigned i) { return bit(a, i < 7 ? i : 7); }); }},
      {"sext.h", [](auto a, auto) { return from_bits([=](unsigned i) { return bit(a, i < 15 ? i : 15); }); }},
      {"zext.h", [](auto a, auto) { return from_bits([=](unsigned i) { return i < 16 && bit(a, i); }); }},
      {"orc.b", [=](auto a, auto) { return from_bits([=](unsigned i) { return byte_of(a, i / 8) != 0; }); }},
      {"rev8", [](auto a, auto) { return from_bits([=](unsigned i) { return bit(a, 8 * (3 - i / 8) + i % 8); }); }},
  };
  return rules;
}

const std::vector<std::uint32_t> kWords{0,          1,          0x80000000, 0x7fffffff, 0xffffffff,
                                        0x00ff0100, 0x12345678, 0xdeadbeef, 0x0000801f, 33};

/// Executes all operations on all pairs of operands, and compares the results with the rules.
TEST(BitManipulation, FollowsTheManual) {
  std::string text = "la s0, words\n la s1, results\n";
  std::vector<std::pair<std::string, std::uint32_t>> expected;
  const auto add = [&](const std::string& instruction, std::uint32_t a, std::uint32_t b, std::uint32_t result) {
    text += fmt::format("li a1, 0x{:x}\n li a2, 0x{:x}\n {}\n sw a0, 0(s1)\n addi s1, s1, 4\n", a, b, instruction);
    expected.emplace_back(fmt::format("{} of {:x} and {:x}", instruction, a, b), result);
  };
  for (const auto a : kWords) {
    for (const auto& [name, rule] : one_operand()) add(name + " a0, a1", a, 0, rule(a, 0));
    for (const auto b : kWords) {
      for (const auto& [name, rule] : two_operands()) add(name + " a0, a1, a2", a, b, rule(a, b));
    }
    for (const auto* name : {"bclr", "bext", "binv", "bset", "ror"}) {
      for (const unsigned number : {0U, 5U, 31U}) {
        add(fmt::format("{}i a0, a1, {}", name, number), a, 0, two_operands().at(name)(a, number));
      }
    }
  }
  text += fmt::format(".data\nwords: .word 0\nresults: .space {}\n.text\n", 4 * expected.size());
  const auto machine = run("rv32imc_zba_zbb_zbc_zbs", text);
  for (unsigned i = 0; i < expected.size(); ++i) {
    ASSERT_EQ(machine->word("results", i), expected[i].second) << expected[i].first;
  }
}

TEST(Atomics, StoreTheResultAndReturnTheOldWord) {
  struct Case {
    const char* name;
    std::uint32_t result;
  };
  // The word in memory is 0x80000005, and the register's value is 12.
  const std::vector<Case> cases{{"amoswap.w", 12}, {"amoadd.w", 0x80000011}, {"amoxor.w", 0x80000009},
                                {"amoand.w", 4},   {"amoor.w", 0x8000000d},  {"amomin.w", 0x80000005},
                                {"amomax.w", 12},  {"amominu.w", 12},        {"amomaxu.w", 0x80000005}};
  for (const auto& [name, result] : cases) {
    const auto machine = run("rv32imac", fmt::format("la a1, word\n li a2, 12\n {}.aqrl a0, a2, (a1)\n"
                                                     ".data\n.balign 4\nword: .word 0x80000005\n.text\n",
                                                     name));
    EXPECT_EQ(machine->reg(10), 0x80000005) << name;
    EXPECT_EQ(machine->word("word"), result) << name;
  }
}

TEST(Atomics, StoreConditionallyOnlyToTheReservedWord) {
  const auto result_of = [](const std::string& between, const std::string& target = "(a1)") {
    return run("rv32imac", fmt::format("la a1, word\n li a2, 7\n lr.w a3, (a1)\n {}\n sc.w a0, a2, {}\n"
                                       ".data\n.balign 4\nword: .word 1, 2\n.text\n",
                                       between, target));
  };
  EXPECT_EQ(result_of("")->reg(10), 0U);
  EXPECT_EQ(result_of("")->word("word"), 7U);
  EXPECT_EQ(result_of("addi a4, a1, 4", "(a4)")->reg(10), 1U) << "another word";
  EXPECT_EQ(result_of("sc.w a4, a2, (a1)")->reg(10), 1U) << "the first sc.w takes the reservation";
  EXPECT_EQ(result_of("sw a2, 0(a1)\n li a2, 9")->word("word"), 7U) << "the word has changed since";
  EXPECT_EQ(run("rv32imac", "la a1, tohost\n sc.w a0, a1, (a1)")->reg(10), 1U) << "without a reservation";
}

TEST(Atomics, TrapIfMisalignedOrOutsideOfMemory) {
  const auto trap = [](const std::string& body) {
    Machine machine(
        Elf::parse(assemble_file(fmt::format("_start: la a0, handler\n csrw mtvec, a0\n li a1, 0x80001000\n{}\n"
                                             "here: j here\n.balign 4\nhandler: csrr a0, mcause\n csrr a2, mtval\n{}",
                                             body, kEnd),
                                 0x80000000, "-march=rv32imac_zicsr"),
                   "test program"),
        MachineSettings{.options = Extension::a});
    machine.run(10'000);
    return std::pair{machine.reg(10), machine.reg(12)};
  };
  EXPECT_EQ(trap("addi a1, a1, 2\n lr.w a3, (a1)"), std::pair(cause::kLoadMisaligned, 0x80001002U));
  EXPECT_EQ(trap("addi a1, a1, 1\n sc.w a3, a1, (a1)"), std::pair(cause::kStoreMisaligned, 0x80001001U));
  EXPECT_EQ(trap("addi a1, a1, 3\n amoadd.w a3, a1, (a1)"), std::pair(cause::kStoreMisaligned, 0x80001003U));
  EXPECT_EQ(trap("li a1, 0x1000\n lr.w a3, (a1)"), std::pair(cause::kLoadAccess, 0x1000U));
  EXPECT_EQ(trap("li a1, 0x1000\n amoor.w a3, a1, (a1)"), std::pair(cause::kStoreAccess, 0x1000U));
}

constexpr auto kFloatsOn = "li t0, 0x6000\n csrs mstatus, t0\n";

TEST(Floats, HaveRegistersFlagsAndCompressedAccesses) {
  const auto machine = run("rv32imfc_zicsr", std::string(kFloatsOn) + R"(
    la s0, numbers
    flw fa0, 0(s0)          # 1.5, 16 bits long
    flw fa1, 4(s0)          # 2^-30
    fadd.s fa2, fa0, fa1    # inexact
    fsw fa2, 8(s0)
    c.addi16sp sp, -16
    mv sp, s0
    c.fswsp fa0, 12(sp)
    c.flwsp fa3, 4(sp)
    fdiv.s fa4, fa0, fs11   # by zero
    fmadd.s fa5, fa0, fa0, fa0
    fcvt.w.s a0, fa5, rmm   # 3.75
    csrr a1, fcsr
    fsrmi 3
    csrr a2, fcsr
    fmv.x.w a3, fa3
    fclass.s a4, fa4
    csrr a5, mstatus
    .data
    .balign 4
    numbers: .word 0x3fc00000, 0x30800000, 0, 0
    .text
  )");
  EXPECT_EQ(machine->word("numbers", 2), 0x3fc00000U);
  EXPECT_EQ(machine->word("numbers", 3), 0x3fc00000U);
  EXPECT_EQ(machine->reg(10), 4U);
  EXPECT_EQ(machine->reg(11), 0x9U) << "inexact, division by zero";
  EXPECT_EQ(machine->reg(12), 0x69U);
  EXPECT_EQ(machine->reg(13), 0x30800000U);
  EXPECT_EQ(machine->reg(14), 1U << 7) << "+infinity";
  EXPECT_EQ(machine->reg(15) & 0x80006000U, 0x80006000U) << "dirty";
  EXPECT_EQ(machine->reg(kFirstFloat + 15), 0x40700000U) << "fa5 = 3.75";
}

/// Returns the word of the program's first illegal instruction; 0 if all instructions are legal.
std::string illegal_at(const std::string& isa, const std::string& body) {
  const auto machine = run(isa, "li a0, 0\n la a0, handler\n csrw mtvec, a0\n" + body +
                                    "\nli a0, 0\n j finish\n.balign 4\nhandler: csrr a0, mtval\nfinish:");
  return fmt::format("{:x}", machine->reg(10));
}

TEST(Floats, AreIllegalWhileTheyAreOffOrRoundByNoMode) {
  EXPECT_EQ(illegal_at("rv32imfc_zicsr", "fmv.w.x fa0, zero"), "f0000553");
  EXPECT_EQ(illegal_at("rv32imfc_zicsr", "csrr a1, fcsr"), "3025f3");
  EXPECT_EQ(illegal_at("rv32imfc_zicsr", std::string(kFloatsOn) + "fmv.w.x fa0, zero\n csrr a1, fcsr"), "0");
  const std::string odd_mode = std::string(kFloatsOn) + "fsrmi 5\n";
  EXPECT_EQ(illegal_at("rv32imfc_zicsr", odd_mode + "fadd.s fa0, fa0, fa0"), "a57553") << "the mode of frm";
  EXPECT_EQ(illegal_at("rv32imfc_zicsr", odd_mode + "fadd.s fa0, fa0, fa0, rtz\n fsgnj.s fa0, fa0, fa0"), "0");
  EXPECT_EQ(illegal_at("rv32imfc_zicsr", std::string(kFloatsOn) + ".word 0x00a55553"), "a55553") << "mode 5";
}

TEST(Floats, UseIntegerRegistersWithZfinx) {
  const auto machine = run("rv32imc_zicsr_zfinx", R"(
    li a1, 0x40490fdb
    fmul.s a2, a1, a1
    fcvt.wu.s a0, a2, rtz
    fadd.s zero, a1, a1
    csrr a3, fflags
    csrr a4, mstatus
  )");
  EXPECT_EQ(machine->reg(12), 0x411de9e7U) << "pi squared";
  EXPECT_EQ(machine->reg(10), 9U);
  EXPECT_EQ(machine->reg(13), 1U);
  EXPECT_EQ(machine->reg(14) & 0x6000U, 0U) << "no registers of floats, so no state of them";
}

TEST(Floats, TakeTheCyclesOfTheManual) {
  const auto cycles = [](const std::string& body) {
    auto machine = run("rv32imfc_zicsr", std::string(kFloatsOn) + "csrr a1, mcycle\n" + body + "\n csrr a0, mcycle\n");
    return machine->reg(10) - machine->reg(11) - 4;  // without the 4 cycles of the first access
  };
  EXPECT_EQ(cycles("fadd.s fa0, fa1, fa2"), 1U);
  EXPECT_EQ(cycles("fmadd.s fa0, fa1, fa2, fa3\n fmul.s fa0, fa0, fa0"), 2U);
  EXPECT_EQ(cycles("fdiv.s fa0, fa1, fa2"), 19U);
  EXPECT_EQ(cycles("fsqrt.s fa0, fa1"), 19U);
  EXPECT_EQ(cycles("la a2, tohost\n flw fa0, 0(a2)\n fadd.s fa1, fa0, fa0"), 5U) << "waits for the load";
}

TEST(Options, AreInMisaAndIllegalWithoutThem) {
  EXPECT_EQ(run("rv32imafcu_zicsr_zba_zbb_zbs", "csrr a0, misa")->reg(10), 0x40101127U) << "A, B, C, F, I, M, U";
  EXPECT_EQ(run("rv32imc_zicsr", "csrr a0, misa")->reg(10), 0x40001104U);
  EXPECT_EQ(illegal_at("rv32imc_zicsr", ".word 0x20a5a533"), "20a5a533") << "sh1add";
  EXPECT_EQ(illegal_at("rv32imc_zicsr_zbb", ".word 0x20a5a533"), "20a5a533");
  EXPECT_EQ(illegal_at("rv32imc_zicsr_zba", ".word 0x20a5a533"), "0");
  EXPECT_EQ(illegal_at("rv32imc_zicsr", "csrr a0, 3"), "302573");
}

}  // namespace
}  // namespace mebots::soc::test
