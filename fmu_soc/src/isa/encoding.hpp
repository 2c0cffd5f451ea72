// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "isa/format.hpp"
#include "isa/op.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

/// The encodings of RV32IMC_Zicsr_Zifencei, the machine-mode instructions and Xpulp v2, from the tables
/// *.decode of this folder. Source: The RISC-V Instruction Set Manual, volume I (20191213) chapters 2, 3, 7, 9, 16, 24
/// and volume II (20211203).
namespace mebots::soc {

/// What a core must have so that a row of the table is an instruction for it.
enum class Extension : std::uint8_t {
  standard,  // RV32IMC_Zicsr_Zifencei, machine mode
  xpulp,     // Xpulp v2 as in RI5CY
};

/// One row of the table: a word is this instruction when `(word & mask) == match` and the operands are not reserved.
struct Encoding {
  std::string_view name;
  Op op;
  Format format;
  std::uint32_t mask;
  std::uint32_t match;
  Extension extension = Extension::standard;
};

/// An instruction taken out of its encoding. Branch and jump immediates are relative to the instruction;
/// `imm` of a CSR instruction is the CSR's number, `rs1` of the immediate forms the 5-bit value. Of Xpulp: `rs2` of
/// p.beqimm and p.bneimm is the 5-bit value, of lp.* the number of the loop; `imm` of lp.setupi is the count, with the
/// distance of the end in the upper half; of a bit field: width - 1 << 5 | position.
struct Decoded {
  Op op = Op::illegal;
  std::uint8_t rd = 0;
  std::uint8_t rs1 = 0;
  std::uint8_t rs2 = 0;
  std::uint8_t rs3 = 0;  // a third register that is read: rd of an accumulation, offset of a store
  Operand operand = Operand::reg;
  std::uint8_t length = 4;  // bytes
  std::int32_t imm = 0;
  const Encoding* encoding = nullptr;
};

/// The whole table.
std::span<const Encoding> encodings();

/// True when the low bits of a word say that the instruction has 16 bits.
constexpr bool is_compressed(std::uint32_t word) {
  return (word & 3U) != 3U;
}

/// Whether the word's operands make this encoding reserved (a zero shift of `c.addi4spn`, ...).
bool is_reserved(const Encoding& encoding, std::uint32_t word);

/// Decodes a 32-bit word, or the 16-bit instruction in its low half. Unknown, reserved, or of an extension beyond
/// `most`: `Op::illegal`.
Decoded decode(std::uint32_t word, Extension most = Extension::xpulp);

/// The immediate as the operation takes it: for all parts of a SIMD operation, the bound of a clip, the selectors of a
/// shuffle. Other immediates as they are.
std::int32_t operand_value(const Decoded& decoded);

/// Assembly text of a word at an address: "addi sp, sp, -16"; ".word 0x..." when illegal.
std::string disassemble(std::uint32_t word, std::uint32_t pc);

/// ABI name of a register: "a0".
std::string_view register_name(unsigned index);

}  // namespace mebots::soc
