// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "isa/op.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

/// The encodings of RV32IMC_Zicsr_Zifencei and the machine-mode instructions.
/// Source: The RISC-V Instruction Set Manual, volume I (20191213) chapters 2, 3, 7, 9, 16, 24 and volume II (20211203).
namespace mebots::soc {

/// Where an encoding keeps its operands. Formats that start with `c` are 16 bits long.
enum class Format : std::uint8_t {
  none,
  r,
  i,
  shift,
  load,
  store,
  branch,
  u,
  jal,
  jalr,
  csr,
  csr_imm,
  fence,
  c_none,
  c_addi4spn,
  c_load,
  c_store,
  c_addi,
  c_jump,
  c_jal,
  c_li,
  c_addi16sp,
  c_lui,
  c_shift,
  c_andi,
  c_alu,
  c_branch,
  c_slli,
  c_lwsp,
  c_swsp,
  c_jr,
  c_jalr,
  c_mv,
  c_add,
};

/// One row of the table: a word is this instruction when `(word & mask) == match` and the operands are not reserved.
struct Encoding {
  std::string_view name;
  Op op;
  Format format;
  std::uint32_t mask;
  std::uint32_t match;
};

/// An instruction taken out of its encoding. Branch and jump immediates are relative to the instruction;
/// `imm` of a CSR instruction is the CSR's number, `rs1` of the immediate forms the 5-bit value.
struct Decoded {
  Op op = Op::illegal;
  std::uint8_t rd = 0;
  std::uint8_t rs1 = 0;
  std::uint8_t rs2 = 0;
  std::uint8_t length = 4;  // bytes
  std::int32_t imm = 0;
  const Encoding* encoding = nullptr;
};

/// The whole table.
std::span<const Encoding> encodings();

constexpr bool is_compressed(Format format) {
  return format >= Format::c_none;
}
/// True when the low bits of a word say that the instruction has 16 bits.
constexpr bool is_compressed(std::uint32_t word) {
  return (word & 3U) != 3U;
}

/// Whether the word's operands make this encoding reserved (a zero shift of `c.addi4spn`, ...).
bool is_reserved(const Encoding& encoding, std::uint32_t word);

/// Decodes a 32-bit word, or the 16-bit instruction in its low half. Unknown or reserved: `Op::illegal`.
Decoded decode(std::uint32_t word);

/// Assembly text of a word at an address: "addi sp, sp, -16"; ".word 0x..." when illegal.
std::string disassemble(std::uint32_t word, std::uint32_t pc);

/// ABI name of a register: "a0".
std::string_view register_name(unsigned index);

}  // namespace mebots::soc
