// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "isa/extension.hpp"
#include "isa/format.hpp"
#include "isa/op.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

/// The encodings of RV32IMC_Zicsr_Zifencei, the machine-mode instructions, the extensions of isa/extension.hpp and
/// Xpulp v2, from the tables *.decode of this folder. Each table names its source.
namespace mebots::soc {

/// A row of the table. A word is this instruction if `(word & mask) == match` and the operands are not reserved.
struct Encoding {
  std::string_view name;
  Op op;
  Format format;
  std::uint32_t mask;
  std::uint32_t match;
  Extension extension = Extension::standard;
};

/// A decoded instruction. Some fields have special meanings:
///
/// - Branches and jumps: `imm` is relative to the instruction's address.
/// - CSR instructions: `imm` is the number of the CSR. If the operand is an immediate, `rs1` is its 5-bit value.
/// - p.beqimm and p.bneimm: `rs2` is the 5-bit value.
/// - Hardware loops (lp.*): `rs2` is the number of the loop. For lp.setupi, the lower half of `imm` is the count, and
///   the upper half is the distance to the end of the loop.
/// - Bit fields: `imm` is `(width - 1) << 5 | position`.
/// - Floating-point operations: registers of F have the numbers from kFirstFloat on. If the operation rounds, `imm` is
///   its rounding mode.
struct Decoded {
  Op op = Op::illegal;
  std::uint8_t rd = 0;
  std::uint8_t rs1 = 0;
  std::uint8_t rs2 = 0;
  std::uint8_t rs3 = 0;  // a third register that is read: rd of an accumulation, or the offset of a store
  Operand operand = Operand::reg;
  std::uint8_t length = 4;  // bytes
  std::int32_t imm = 0;
  const Encoding* encoding = nullptr;
};

/// Returns the whole table.
std::span<const Encoding> encodings();

/// True if the low bits of a word mark a 16-bit instruction.
constexpr bool is_compressed(std::uint32_t word) {
  return (word & 3U) != 3U;
}

/// True if the operands make this encoding reserved (such as a zero shift of `c.addi4spn`).
bool is_reserved(const Encoding& encoding, std::uint32_t word);

/// Decodes a 32-bit word, or the 16-bit instruction in its low half. If the word is unknown, reserved, or needs an
/// extension that `has` lacks, returns `Op::illegal`.
Decoded decode(std::uint32_t word, Extensions has = kMostExtensions);

/// Returns the immediate in the form that the operation uses. For SIMD, the immediate is copied to all parts. For a
/// clip, it becomes the bound; for a shuffle, the selectors. Other immediates are unchanged.
std::int32_t operand_value(const Decoded& decoded);

/// Returns the assembly text of a word at an address, such as "addi sp, sp, -16"; ".word 0x..." if it is illegal.
std::string disassemble(std::uint32_t word, std::uint32_t pc, Extensions has = kMostExtensions);

/// Returns the ABI name of a register, such as "a0", or "fa0" from kFirstFloat on.
std::string_view register_name(unsigned index);

}  // namespace mebots::soc
