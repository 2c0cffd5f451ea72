// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "isa/extension.hpp"
#include "isa/format.hpp"
#include "isa/op.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

/// Encodings of RV32IMC_Zicsr_Zifencei, of the machine-mode instructions, of the extensions in isa/extension.hpp, and
/// of Xpulp v2. They come from the tables *.decode in this folder, which name their sources.
namespace mebots::soc {

/// An encoding of an instruction. A word has this encoding if `(word & mask) == match` and the operands are not
/// reserved.
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
  std::uint8_t rs3 = 0;  // third source register: rd of an accumulation, offset of a store, rs3 of a fused multiply-add
  Operand operand = Operand::reg;
  std::uint8_t length = 4;  // bytes
  std::int32_t imm = 0;
  const Encoding* encoding = nullptr;
};

std::span<const Encoding> encodings();

constexpr bool is_compressed(std::uint32_t word) {
  return (word & 3U) != 3U;
}

/// Returns true if the operands make the word a reserved encoding, such as a zero immediate of `c.addi4spn`.
bool is_reserved(const Encoding& encoding, std::uint32_t word);

/// Decodes a 32-bit word, or the 16-bit instruction in its low half. Returns `Op::illegal` if the word is unknown or
/// reserved, or if it needs an extension that `has` lacks.
Decoded decode(std::uint32_t word, Extensions has = kMostExtensions);

/// Returns the immediate as the operation uses it: copied to all parts for SIMD, converted to the bound for a clip, and
/// converted to the selectors for a shuffle. Other immediates are unchanged.
std::int32_t operand_value(const Decoded& decoded);

/// Returns the assembly text of a word at the address `pc`, such as "addi sp, sp, -16", or ".word 0x..." for an illegal
/// word.
std::string disassemble(std::uint32_t word, std::uint32_t pc, Extensions has = kMostExtensions);

/// Returns the ABI name of a register, such as "a0" or, from kFirstFloat on, "fa0".
std::string_view register_name(unsigned index);

}  // namespace mebots::soc
