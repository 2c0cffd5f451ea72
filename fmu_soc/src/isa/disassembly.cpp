// SPDX-License-Identifier: Apache-2.0
#include "isa/encoding.hpp"

#include <fmt/core.h>

#include <array>

namespace mebots::soc {
namespace {

constexpr std::array<std::string_view, kRegisters> kNames{
    "zero", "ra",  "sp",  "gp",  "tp",  "t0",  "t1",   "t2",   "s0",  "s1",  "a0",   "a1",  "a2",
    "a3",   "a4",  "a5",  "a6",  "a7",  "s2",  "s3",   "s4",   "s5",  "s6",  "s7",   "s8",  "s9",
    "s10",  "s11", "t3",  "t4",  "t5",  "t6",  "ft0",  "ft1",  "ft2", "ft3", "ft4",  "ft5", "ft6",
    "ft7",  "fs0", "fs1", "fa0", "fa1", "fa2", "fa3",  "fa4",  "fa5", "fa6", "fa7",  "fs2", "fs3",
    "fs4",  "fs5", "fs6", "fs7", "fs8", "fs9", "fs10", "fs11", "ft8", "ft9", "ft10", "ft11"};

/// Text of each rounding mode, as binutils writes it. The text is empty for the rounding mode in frm.
constexpr std::array<std::string_view, 8> kRoundings{", rne", ", rtz", ", rdn", ", rup", ", rmm", "", "", ""};

/// Returns the assembly text of an instruction's operands. The format (formats.decode) contains a text in which the
/// names in braces are replaced by values.
std::string operands(const Decoded& d, std::uint32_t pc) {
  const auto imm = static_cast<std::uint32_t>(d.imm);
  return fmt::format(fmt::runtime(row_of(d.encoding->format).text),           //
                     fmt::arg("rd", kNames[d.rd]),                            //
                     fmt::arg("rs1", kNames[d.rs1]),                          //
                     fmt::arg("rs2", kNames[d.rs2]),                          //
                     fmt::arg("rs3", kNames[d.rs3]),                          //
                     fmt::arg("rs1_number", d.rs1),                           //
                     fmt::arg("rs2_number", d.rs2),                           //
                     fmt::arg("rs2_value", d.rs2 < 16 ? d.rs2 : d.rs2 - 32),  //
                     fmt::arg("imm", d.imm),                                  //
                     fmt::arg("rounding", kRoundings[imm & 7U]),              //
                     fmt::arg("upper", imm >> 12),                            //
                     fmt::arg("width", imm >> 5),                             //
                     fmt::arg("position", imm & 31U),                         //
                     fmt::arg("low_six_bits", imm & 63U),                     //
                     fmt::arg("low_half", imm & 0xffffU),                     //
                     fmt::arg("target", pc + imm),                            //
                     fmt::arg("target_of_high_half", pc + (imm >> 16)));
}

}  // namespace

std::string_view register_name(unsigned index) {
  return kNames[index];
}

std::string disassemble(std::uint32_t word, std::uint32_t pc, Extensions has) {
  const auto decoded = decode(word, has);
  if (decoded.op == Op::illegal) {
    return decoded.length == 2 ? fmt::format(".half 0x{:04x}", word & 0xffffU) : fmt::format(".word 0x{:08x}", word);
  }
  return fmt::format("{}{}", decoded.encoding->name, operands(decoded, pc));
}

}  // namespace mebots::soc
