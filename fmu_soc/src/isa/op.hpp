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
  p_beqimm,
  p_bneimm,
  // Loads, with Xpulp's: offset in a register, post-increment by an immediate, by a register, event load
  lb,
  lh,
  lw,
  lbu,
  lhu,
  p_lb_reg,
  p_lh_reg,
  p_lw_reg,
  p_lbu_reg,
  p_lhu_reg,
  p_lb_post,
  p_lh_post,
  p_lw_post,
  p_lbu_post,
  p_lhu_post,
  p_lb_post_reg,
  p_lh_post_reg,
  p_lw_post_reg,
  p_lbu_post_reg,
  p_lhu_post_reg,
  p_elw,
  // Stores, likewise
  sb,
  sh,
  sw,
  p_sb_reg,
  p_sh_reg,
  p_sw_reg,
  p_sb_post,
  p_sh_post,
  p_sw_post,
  p_sb_post_reg,
  p_sh_post_reg,
  p_sw_post_reg,
  // Computing
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
  // Xpulp: hardware loops
  lp_starti,
  lp_endi,
  lp_count,
  lp_counti,
  lp_setup,
  lp_setupi,
  // Xpulp: general ALU
  p_abs,
  p_slet,
  p_sletu,
  p_min,
  p_minu,
  p_max,
  p_maxu,
  p_exths,
  p_exthz,
  p_extbs,
  p_extbz,
  p_clip,
  p_clipu,
  // Xpulp: add and subtract, then shift right (and round); shift by an immediate, by a register
  p_addN,
  p_adduN,
  p_addRN,
  p_adduRN,
  p_subN,
  p_subuN,
  p_subRN,
  p_subuRN,
  p_addNr,
  p_adduNr,
  p_addRNr,
  p_adduRNr,
  p_subNr,
  p_subuNr,
  p_subRNr,
  p_subuRNr,
  // Xpulp: bits; the immediate and the register form are the same operation
  p_extract,
  p_extractu,
  p_insert,
  p_bclr,
  p_bset,
  p_ff1,
  p_fl1,
  p_clb,
  p_cnt,
  p_ror,
  // Xpulp: multiply and accumulate
  p_mac,
  p_msu,
  p_mulsN,
  p_mulhhsN,
  p_mulsRN,
  p_mulhhsRN,
  p_muluN,
  p_mulhhuN,
  p_muluRN,
  p_mulhhuRN,
  p_macsN,
  p_machhsN,
  p_macsRN,
  p_machhsRN,
  p_macuN,
  p_machhuN,
  p_macuRN,
  p_machhuRN,
  // Xpulp: SIMD on two halves (h) and four bytes (b); vector, scalar and immediate forms are the same operation
  pv_add_h,
  pv_add_b,
  pv_sub_h,
  pv_sub_b,
  pv_avg_h,
  pv_avg_b,
  pv_avgu_h,
  pv_avgu_b,
  pv_min_h,
  pv_min_b,
  pv_minu_h,
  pv_minu_b,
  pv_max_h,
  pv_max_b,
  pv_maxu_h,
  pv_maxu_b,
  pv_srl_h,
  pv_srl_b,
  pv_sra_h,
  pv_sra_b,
  pv_sll_h,
  pv_sll_b,
  pv_or_h,
  pv_or_b,
  pv_xor_h,
  pv_xor_b,
  pv_and_h,
  pv_and_b,
  pv_abs_h,
  pv_abs_b,
  pv_extract_h,
  pv_extract_b,
  pv_extractu_h,
  pv_extractu_b,
  pv_insert_h,
  pv_insert_b,
  pv_shuffle_h,
  pv_shuffle_b,
  pv_shuffle2_h,
  pv_shuffle2_b,
  pv_pack_h,
  pv_packhi_b,
  pv_packlo_b,
  pv_cmpeq_h,
  pv_cmpeq_b,
  pv_cmpne_h,
  pv_cmpne_b,
  pv_cmpgt_h,
  pv_cmpgt_b,
  pv_cmpge_h,
  pv_cmpge_b,
  pv_cmplt_h,
  pv_cmplt_b,
  pv_cmple_h,
  pv_cmple_b,
  pv_cmpgtu_h,
  pv_cmpgtu_b,
  pv_cmpgeu_h,
  pv_cmpgeu_b,
  pv_cmpltu_h,
  pv_cmpltu_b,
  pv_cmpleu_h,
  pv_cmpleu_b,
  pv_dotup_h,
  pv_dotup_b,
  pv_dotusp_h,
  pv_dotusp_b,
  pv_dotsp_h,
  pv_dotsp_b,
  pv_sdotup_h,
  pv_sdotup_b,
  pv_sdotusp_h,
  pv_sdotusp_b,
  pv_sdotsp_h,
  pv_sdotsp_b,
  // Not encodings: the end of a decoded block, and one that a hardware loop may end
  end_of_block,
  loop_end,
};
inline constexpr int kOpCount = static_cast<int>(Op::loop_end) + 1;

constexpr bool is_load(Op op) {
  return op >= Op::lb && op <= Op::p_elw;
}
constexpr bool is_store(Op op) {
  return op >= Op::sb && op <= Op::p_sw_post_reg;
}
/// Adds to its address register after the access.
constexpr bool is_post_increment(Op op) {
  return (op >= Op::p_lb_post && op <= Op::p_lhu_post_reg) || (op >= Op::p_sb_post && op <= Op::p_sw_post_reg);
}
constexpr bool is_branch(Op op) {
  return op >= Op::beq && op <= Op::p_bneimm;
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

/// Also reads the register that it writes.
constexpr bool reads_rd(Op op) {
  return (op >= Op::p_addNr && op <= Op::p_subuRNr) || op == Op::p_insert || op == Op::p_mac || op == Op::p_msu ||
         (op >= Op::p_macsN && op <= Op::p_machhuRN) || op == Op::pv_insert_h || op == Op::pv_insert_b ||
         op == Op::pv_shuffle2_h || op == Op::pv_shuffle2_b || op == Op::pv_packhi_b || op == Op::pv_packlo_b ||
         (op >= Op::pv_sdotup_h && op <= Op::pv_sdotsp_b);
}
constexpr bool is_hardware_loop(Op op) {
  return op >= Op::lp_starti && op <= Op::lp_setupi;
}
/// Works on halves or bytes of its operands.
constexpr bool is_simd(Op op) {
  return op >= Op::pv_add_h && op <= Op::pv_sdotsp_b;
}
constexpr bool is_dot_product(Op op) {
  return op >= Op::pv_dotup_h && op <= Op::pv_sdotsp_b;
}
constexpr bool is_multiply_accumulate(Op op) {
  return op >= Op::p_mac && op <= Op::p_machhuRN;
}

/// Not an instruction: stands behind the last one of a decoded block.
constexpr bool is_block_end(Op op) {
  return op == Op::end_of_block || op == Op::loop_end;
}

/// Ends a block of straight code: the next instruction is not known, or what it does may depend on this one.
constexpr bool ends_block(Op op) {
  return is_jump(op) || is_csr(op) || op == Op::illegal || op == Op::ecall || op == Op::ebreak || op == Op::fence_i ||
         op == Op::mret || op == Op::wfi || op == Op::lp_endi || op == Op::lp_setup || op == Op::lp_setupi;
}

}  // namespace mebots::soc
