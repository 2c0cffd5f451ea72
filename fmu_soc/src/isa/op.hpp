// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace mebots::soc {

/// What an instruction does, whatever its encoding: `c.addi` and `addi` are both `addi`.
enum class Op : std::uint8_t {
  illegal,
  // RV32I
  lui,
  auipc,
  jal,
  jalr,
  beq,
  bne,
  blt,
  bge,
  bltu,
  bgeu,
  lb,
  lh,
  lw,
  lbu,
  lhu,
  sb,
  sh,
  sw,
  addi,
  slti,
  sltiu,
  xori,
  ori,
  andi,
  slli,
  srli,
  srai,
  add,
  sub,
  sll,
  slt,
  sltu,
  xor_,
  srl,
  sra,
  or_,
  and_,
  fence,
  ecall,
  ebreak,
  // M
  mul,
  mulh,
  mulhsu,
  mulhu,
  div,
  divu,
  rem,
  remu,
  // Zifencei, Zicsr
  fence_i,
  csrrw,
  csrrs,
  csrrc,
  csrrwi,
  csrrsi,
  csrrci,
  // Machine mode
  mret,
  wfi,
  // Not an encoding: the end of a decoded block
  end_of_block,
};
inline constexpr int kOpCount = static_cast<int>(Op::end_of_block) + 1;

constexpr bool is_load(Op op) {
  return op >= Op::lb && op <= Op::lhu;
}
constexpr bool is_store(Op op) {
  return op >= Op::sb && op <= Op::sw;
}
constexpr bool is_branch(Op op) {
  return op >= Op::beq && op <= Op::bgeu;
}
constexpr bool is_jump(Op op) {
  return op == Op::jal || op == Op::jalr;
}
constexpr bool is_multiply_high(Op op) {
  return op >= Op::mulh && op <= Op::mulhu;
}
constexpr bool is_divide(Op op) {
  return op >= Op::div && op <= Op::remu;
}
constexpr bool is_csr(Op op) {
  return op >= Op::csrrw && op <= Op::csrrci;
}

/// Ends a block of straight code: the next instruction is not known, or what it does may depend on this one.
constexpr bool ends_block(Op op) {
  return is_jump(op) || is_csr(op) || op == Op::illegal || op == Op::ecall || op == Op::ebreak || op == Op::fence_i ||
         op == Op::mret || op == Op::wfi;
}

}  // namespace mebots::soc
