// SPDX-License-Identifier: Apache-2.0
// Compares the results of each instruction with a second implementation, bit by bit or in wider integers. Debian's
// assembler encodes the programs, so the tests also find wrong encodings.
#include "machine.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>

namespace mebots::soc::test {
namespace {

__extension__ using Wide = __int128;

Wide value_of(std::uint32_t word, bool with_sign) {
  Wide value = 0;
  for (int bit = 0; bit < 32; ++bit) {
    if ((word >> bit & 1U) == 0) continue;
    const auto weight = Wide{1} << bit;
    value += with_sign && bit == 31 ? -weight : weight;
  }
  return value;
}

std::uint32_t word_of(Wide value) {
  return static_cast<std::uint32_t>(value & Wide{0xffffffff});
}

/// Returns the quotient rounded towards zero, by repeated subtraction of shifted divisors.
Wide quotient(Wide dividend, Wide divisor) {
  const bool negative = (dividend < 0) != (divisor < 0);
  Wide rest = dividend < 0 ? -dividend : dividend;
  const Wide step = divisor < 0 ? -divisor : divisor;
  Wide result = 0;
  for (int bit = 33; bit >= 0; --bit) {
    if ((step << bit) <= rest) {
      rest -= step << bit;
      result += Wide{1} << bit;
    }
  }
  return negative ? -result : result;
}

std::uint32_t bitwise(std::uint32_t a, std::uint32_t b, const std::function<bool(bool, bool)>& rule) {
  std::uint32_t result = 0;
  for (int bit = 0; bit < 32; ++bit) {
    if (rule((a >> bit & 1U) != 0, (b >> bit & 1U) != 0)) result |= 1U << bit;
  }
  return result;
}

std::uint32_t shifted(std::uint32_t a, int left, bool fill_with_sign) {
  std::uint32_t result = 0;
  for (int bit = 0; bit < 32; ++bit) {
    const int from = bit - left;
    const bool one = from < 0 ? false : from > 31 ? fill_with_sign && (a >> 31) != 0 : (a >> from & 1U) != 0;
    if (one) result |= 1U << bit;
  }
  return result;
}

using Rule = std::function<std::uint32_t(std::uint32_t, std::uint32_t)>;

struct Operation {
  std::string name;
  Rule rule;
};

const std::vector<std::uint32_t> kOperands{0,          1,          2,          5,          31,
                                           32,         0x7ff,      0xfffff800, 0x12345678, 0x7fffffff,
                                           0x80000000, 0x80000001, 0xdeadbeef, 0xfffffffe, 0xffffffff};

std::vector<Operation> register_operations() {
  const auto high = [](bool a_sign, bool b_sign) {
    return [=](std::uint32_t a, std::uint32_t b) { return word_of((value_of(a, a_sign) * value_of(b, b_sign)) >> 32); };
  };
  const auto divided = [](bool with_sign) {
    return [=](std::uint32_t a, std::uint32_t b) {
      return b == 0 ? 0xffffffffU : word_of(quotient(value_of(a, with_sign), value_of(b, with_sign)));
    };
  };
  const auto remainder = [](bool with_sign) {
    return [=](std::uint32_t a, std::uint32_t b) {
      if (b == 0) return a;
      const auto dividend = value_of(a, with_sign);
      const auto divisor = value_of(b, with_sign);
      return word_of(dividend - quotient(dividend, divisor) * divisor);
    };
  };
  const auto less = [](bool with_sign) {
    return [=](std::uint32_t a, std::uint32_t b) { return value_of(a, with_sign) < value_of(b, with_sign) ? 1U : 0U; };
  };
  return {
      {"add", [](auto a, auto b) { return word_of(value_of(a, true) + value_of(b, true)); }},
      {"sub", [](auto a, auto b) { return word_of(value_of(a, true) - value_of(b, true)); }},
      {"sll", [](auto a, auto b) { return shifted(a, static_cast<int>(b % 32), false); }},
      {"srl", [](auto a, auto b) { return shifted(a, -static_cast<int>(b % 32), false); }},
      {"sra", [](auto a, auto b) { return shifted(a, -static_cast<int>(b % 32), true); }},
      {"slt", less(true)},
      {"sltu", less(false)},
      {"xor", [](auto a, auto b) { return bitwise(a, b, [](bool x, bool y) { return x != y; }); }},
      {"or", [](auto a, auto b) { return bitwise(a, b, [](bool x, bool y) { return x || y; }); }},
      {"and", [](auto a, auto b) { return bitwise(a, b, [](bool x, bool y) { return x && y; }); }},
      {"mul", [](auto a, auto b) { return word_of(value_of(a, true) * value_of(b, true)); }},
      {"mulh", high(true, true)},
      {"mulhsu", high(true, false)},
      {"mulhu", high(false, false)},
      {"div", divided(true)},
      {"divu", divided(false)},
      {"rem", remainder(true)},
      {"remu", remainder(false)},
  };
}

/// Runs `body` once for each pair of operands, which are in a0 and a1. The result is in a2.
void expect_for_all_pairs(const std::string& name, const std::string& body, const Rule& rule) {
  std::string program = "_start: la s0, results\nla s1, operands\n";
  program += fmt::format(
      "li s2, {0}\nmv s3, s1\n2: lw a0, 0(s3)\naddi s3, s3, 4\nli s4, {0}\nmv s5, s1\n"
      "3: lw a1, 0(s5)\naddi s5, s5, 4\n{1}\nsw a2, 0(s0)\naddi s0, s0, 4\naddi s4, s4, -1\n"
      "bnez s4, 3b\naddi s2, s2, -1\nbnez s2, 2b\n",
      kOperands.size(), body);
  program += kEnd;
  program += ".data\n.balign 4\noperands: ";
  for (const auto operand : kOperands) program += fmt::format(".word 0x{:x}\n", operand);
  program += fmt::format("results: .space {}\n", 4 * kOperands.size() * kOperands.size());
  Machine machine(program);
  ASSERT_EQ(machine.run(), Stop::watch) << name;
  std::uint32_t index = 0;
  for (const auto a : kOperands) {
    for (const auto b : kOperands) {
      EXPECT_EQ(machine.word("results", index++), rule(a, b)) << fmt::format("{} 0x{:x}, 0x{:x}", name, a, b);
    }
  }
}

TEST(Instruction, OnTwoRegistersComputesAsInTheManual) {
  for (const auto& operation : register_operations()) {
    expect_for_all_pairs(operation.name, ".option norvc\n" + operation.name + " a2, a0, a1\n.option rvc",
                         operation.rule);
  }
}

TEST(Instruction, CompressedOnTwoRegistersComputesTheSame) {
  for (const auto& operation : register_operations()) {
    if (operation.name != "sub" && operation.name != "xor" && operation.name != "or" && operation.name != "and" &&
        operation.name != "add") {
      continue;
    }
    expect_for_all_pairs("c." + operation.name, fmt::format("c.mv a2, a0\nc.{} a2, a1", operation.name),
                         operation.rule);
  }
}

TEST(Instruction, ComputesTheSameWithAnImmediateAsWithARegister) {
  const std::vector<std::pair<std::string, std::string>> pairs{{"addi", "add"}, {"slti", "slt"}, {"sltiu", "sltu"},
                                                               {"xori", "xor"}, {"ori", "or"},   {"andi", "and"},
                                                               {"slli", "sll"}, {"srli", "srl"}, {"srai", "sra"}};
  const auto operations = register_operations();
  for (const auto& [name, register_name] : pairs) {
    const auto found =
        std::find_if(operations.begin(), operations.end(), [&](const auto& o) { return o.name == register_name; });
    for (const int immediate : {0, 1, 17, 31, -1, -2048, 2047}) {
      if (name[0] == 's' && name[1] != 'l' && (immediate < 0 || immediate > 31)) continue;  // srli, srai
      if (name == "slli" && (immediate < 0 || immediate > 31)) continue;
      const auto rule = [&, value = static_cast<std::uint32_t>(immediate)](std::uint32_t a, std::uint32_t) {
        return found->rule(a, value);
      };
      expect_for_all_pairs(name, fmt::format(".option norvc\n{} a2, a0, {}\n.option rvc", name, immediate), rule);
    }
  }
}

TEST(Instruction, BranchesAreTakenIfTheirRelationHolds) {
  const auto relation = [](bool with_sign, int sign, bool inverted) {
    return [=](std::uint32_t a, std::uint32_t b) {
      const auto difference = value_of(a, with_sign) - value_of(b, with_sign);
      const bool holds = sign == 0 ? difference == 0 : difference < 0;
      return holds != inverted ? 1U : 0U;
    };
  };
  const std::vector<Operation> branches{{"beq", relation(true, 0, false)},    {"bne", relation(true, 0, true)},
                                        {"blt", relation(true, -1, false)},   {"bge", relation(true, -1, true)},
                                        {"bltu", relation(false, -1, false)}, {"bgeu", relation(false, -1, true)}};
  for (const auto& branch : branches) {
    expect_for_all_pairs(branch.name, fmt::format("li a2, 1\n{} a0, a1, 4f\nli a2, 0\n4:", branch.name), branch.rule);
  }
}

TEST(Instruction, LoadsExtendByTheirName) {
  Machine machine(fmt::format(R"(
_start: la s0, data
    lb a0, 1(s0)
    lbu a1, 1(s0)
    lh a2, 2(s0)
    lhu a3, 2(s0)
    lw a4, 0(s0)
    lw a5, 1(s0)
    lh a6, 3(s0)
    {}
    .data
    .balign 4
data: .byte 0x01, 0x82, 0x83, 0x94, 0x75, 0x06
)",
                              kEnd));
  ASSERT_EQ(machine.run(), Stop::watch);
  EXPECT_EQ(machine.reg(10), 0xffffff82U);
  EXPECT_EQ(machine.reg(11), 0x00000082U);
  EXPECT_EQ(machine.reg(12), 0xffff9483U);
  EXPECT_EQ(machine.reg(13), 0x00009483U);
  EXPECT_EQ(machine.reg(14), 0x94838201U);
  EXPECT_EQ(machine.reg(15), 0x75948382U) << "a misaligned word, done in hardware";
  EXPECT_EQ(machine.reg(16), 0x00007594U) << "a misaligned half word across a word";
}

TEST(Instruction, StoresWriteOnlyTheirBytes) {
  Machine machine(fmt::format(R"(
_start: la s0, data
    li a0, 0x11223344
    sb a0, 1(s0)
    sh a0, 4(s0)
    sw a0, 9(s0)
    c.sw a0, 16(s0)
    {}
    .data
    .balign 4
data: .fill 8, 4, 0xffffffff
)",
                              kEnd));
  ASSERT_EQ(machine.run(), Stop::watch);
  EXPECT_EQ(machine.word("data", 0), 0xffff44ffU);
  EXPECT_EQ(machine.word("data", 1), 0xffff3344U);
  EXPECT_EQ(machine.word("data", 2), 0x223344ffU);
  EXPECT_EQ(machine.word("data", 3), 0xffffff11U);
  EXPECT_EQ(machine.word("data", 4), 0x11223344U);
  EXPECT_EQ(machine.word("data", 5), 0xffffffffU);
}

TEST(Instruction, CompressedFormsExpandToTheirLongOnes) {
  Machine machine(fmt::format(R"(
_start: la sp, stack
    la s0, 1f
    c.li a0, -7
    c.lui a1, 0xfffe1
    c.addi a0, 3
    c.addi4spn a2, sp, 16
    mv a3, sp
    c.addi16sp sp, -64
    c.sub a3, a2
    c.li a4, -1
    c.srli a4, 28
    c.li a5, -16
    c.srai a5, 2
    c.slli a5, 4
    c.andi a4, 6
    c.swsp a0, 4(sp)
    c.lwsp s2, 4(sp)
    c.jalr s0
back: c.j 2f
1:  c.jr ra
2:  c.beqz a0, 3f
    c.li s3, 5
    c.bnez a0, 4f
3:  c.li s3, 9
4:  c.mv s4, s3
    c.add s4, s4
    {}
    .data
    .balign 16
    .space 128
stack: .space 64
)",
                              kEnd));
  ASSERT_EQ(machine.run(), Stop::watch);
  EXPECT_EQ(machine.reg(10), static_cast<std::uint32_t>(-4));
  EXPECT_EQ(machine.reg(11), 0xfffe1000U);
  EXPECT_EQ(machine.reg(12), *machine.program().symbol("stack") + 16);
  EXPECT_EQ(machine.reg(13), static_cast<std::uint32_t>(-16));
  EXPECT_EQ(machine.reg(2), *machine.program().symbol("stack") - 64);
  EXPECT_EQ(machine.reg(14), 6U);
  EXPECT_EQ(machine.reg(15), static_cast<std::uint32_t>(-64));
  EXPECT_EQ(machine.reg(18), static_cast<std::uint32_t>(-4));
  EXPECT_EQ(machine.reg(1), *machine.program().symbol("back"));
  EXPECT_EQ(machine.reg(19), 5U);
  EXPECT_EQ(machine.reg(20), 10U);
}

TEST(Instruction, RegisterZeroStaysZero) {
  Machine machine(
      fmt::format("_start: .option norvc\nli a0, 5\nadd zero, a0, a0\nlui zero, 1\nlw zero, 0(sp)\n"
                  "jal zero, 2f\n2: mv a1, zero\n{}",
                  kEnd));
  machine.hart().set_reg(2, Machine::kRam);
  ASSERT_EQ(machine.run(), Stop::watch);
  EXPECT_EQ(machine.reg(11), 0U);
  EXPECT_EQ(machine.reg(0), 0U);
}

TEST(Instruction, JumpsLinkAndClearTheLowestBit) {
  Machine machine(fmt::format(R"(
_start: .option norvc
    jal s0, 1f
after: nop
1:  la t0, 2f
    addi t0, t0, 5
    jalr t0, -4(t0)
linked: nop
2:  auipc a0, 0x12345
here: {}
)",
                              kEnd));
  ASSERT_EQ(machine.run(), Stop::watch);
  EXPECT_EQ(machine.reg(8), *machine.program().symbol("after"));
  EXPECT_EQ(machine.reg(10), *machine.program().symbol("here") - 4 + 0x12345000U);
}

}  // namespace
}  // namespace mebots::soc::test
