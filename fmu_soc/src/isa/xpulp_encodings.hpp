// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "isa/encoding.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

/// The rows of Xpulp v2 in the table of encodings, made from its structure.
///
/// Sources: RI5CY user manual 4.45 chapter 14; the decoder of RI5CY's RTL (pulp-platform/riscv, February 2018); GVSoC's
/// isa_pulpv2.py. Where they disagree (p.clipr, which the manual puts on top of p.clipu), RTL and GVSoC are followed.
namespace mebots::soc::xpulp {

inline constexpr std::uint32_t kLoad = 0x03;
inline constexpr std::uint32_t kLoadPost = 0x0b;
inline constexpr std::uint32_t kStore = 0x23;
inline constexpr std::uint32_t kStorePost = 0x2b;
inline constexpr std::uint32_t kAlu = 0x33;
inline constexpr std::uint32_t kSimd = 0x57;
inline constexpr std::uint32_t kShifted = 0x5b;
inline constexpr std::uint32_t kBranch = 0x63;
inline constexpr std::uint32_t kLoop = 0x7b;

constexpr std::uint32_t word(std::uint32_t opcode, std::uint32_t funct3, std::uint32_t funct7 = 0) {
  return opcode | funct3 << 12 | funct7 << 25;
}

inline constexpr std::uint32_t kFunct3 = 0x0000707f;
inline constexpr std::uint32_t kFunct7 = 0xfe00707f;
inline constexpr std::uint32_t kFunct7NoRs2 = 0xfff0707f;  // rs2 = 0
inline constexpr std::uint32_t kTop2 = 0xc000707f;         // bits 31:30
inline constexpr std::uint32_t kTop6 = 0xfc00707f;         // bits 31:26
inline constexpr std::uint32_t kTop6NoRs2 = 0xfdf0707f;
inline constexpr std::uint32_t kLoopMask = 0x00007f7f;  // funct3 and bits 11:8

// clang-format off
inline constexpr auto kScalarRows = std::to_array<Encoding>({
    // Branches against a 5-bit immediate
    {"p.beqimm", Op::p_beqimm, Format::branch_imm, kFunct3, word(kBranch, 2)},
    {"p.bneimm", Op::p_bneimm, Format::branch_imm, kFunct3, word(kBranch, 3)},
    // Loads: offset in a register; post-increment by an immediate, by a register
    {"p.lb",  Op::p_lb_reg,  Format::load_reg, kFunct7, word(kLoad, 7, 0x00)},
    {"p.lh",  Op::p_lh_reg,  Format::load_reg, kFunct7, word(kLoad, 7, 0x08)},
    {"p.lw",  Op::p_lw_reg,  Format::load_reg, kFunct7, word(kLoad, 7, 0x10)},
    {"p.lbu", Op::p_lbu_reg, Format::load_reg, kFunct7, word(kLoad, 7, 0x20)},
    {"p.lhu", Op::p_lhu_reg, Format::load_reg, kFunct7, word(kLoad, 7, 0x28)},
    {"p.lb",  Op::p_lb_post,  Format::load_post, kFunct3, word(kLoadPost, 0)},
    {"p.lh",  Op::p_lh_post,  Format::load_post, kFunct3, word(kLoadPost, 1)},
    {"p.lw",  Op::p_lw_post,  Format::load_post, kFunct3, word(kLoadPost, 2)},
    {"p.lbu", Op::p_lbu_post, Format::load_post, kFunct3, word(kLoadPost, 4)},
    {"p.lhu", Op::p_lhu_post, Format::load_post, kFunct3, word(kLoadPost, 5)},
    {"p.lb",  Op::p_lb_post_reg,  Format::load_post_reg, kFunct7, word(kLoadPost, 7, 0x00)},
    {"p.lh",  Op::p_lh_post_reg,  Format::load_post_reg, kFunct7, word(kLoadPost, 7, 0x08)},
    {"p.lw",  Op::p_lw_post_reg,  Format::load_post_reg, kFunct7, word(kLoadPost, 7, 0x10)},
    {"p.lbu", Op::p_lbu_post_reg, Format::load_post_reg, kFunct7, word(kLoadPost, 7, 0x20)},
    {"p.lhu", Op::p_lhu_post_reg, Format::load_post_reg, kFunct7, word(kLoadPost, 7, 0x28)},
    {"p.elw", Op::p_elw,     Format::load,     kFunct3, word(kLoad, 6)},
    // Stores, likewise; the offset or increment register stands in the place of rd
    {"p.sb", Op::p_sb_reg, Format::store_reg, kFunct7, word(kStore, 4)},
    {"p.sh", Op::p_sh_reg, Format::store_reg, kFunct7, word(kStore, 5)},
    {"p.sw", Op::p_sw_reg, Format::store_reg, kFunct7, word(kStore, 6)},
    {"p.sb", Op::p_sb_post, Format::store_post, kFunct3, word(kStorePost, 0)},
    {"p.sh", Op::p_sh_post, Format::store_post, kFunct3, word(kStorePost, 1)},
    {"p.sw", Op::p_sw_post, Format::store_post, kFunct3, word(kStorePost, 2)},
    {"p.sb", Op::p_sb_post_reg, Format::store_post_reg, kFunct7, word(kStorePost, 4)},
    {"p.sh", Op::p_sh_post_reg, Format::store_post_reg, kFunct7, word(kStorePost, 5)},
    {"p.sw", Op::p_sw_post_reg, Format::store_post_reg, kFunct7, word(kStorePost, 6)},
    // Hardware loops
    {"lp.starti", Op::lp_starti, Format::loop_target, kLoopMask, word(kLoop, 0)},
    {"lp.endi",   Op::lp_endi,   Format::loop_target, kLoopMask, word(kLoop, 1)},
    {"lp.count",  Op::lp_count,  Format::loop_count,  kLoopMask, word(kLoop, 2)},
    {"lp.counti", Op::lp_counti, Format::loop_counti, kLoopMask, word(kLoop, 3)},
    {"lp.setup",  Op::lp_setup,  Format::loop_setup,  kLoopMask, word(kLoop, 4)},
    {"lp.setupi", Op::lp_setupi, Format::loop_setupi, kLoopMask, word(kLoop, 5)},
    // General ALU
    {"p.abs",   Op::p_abs,   Format::unary, kFunct7NoRs2, word(kAlu, 0, 0x02)},
    {"p.slet",  Op::p_slet,  Format::r,     kFunct7, word(kAlu, 2, 0x02)},
    {"p.sletu", Op::p_sletu, Format::r,     kFunct7, word(kAlu, 3, 0x02)},
    {"p.min",   Op::p_min,   Format::r,     kFunct7, word(kAlu, 4, 0x02)},
    {"p.minu",  Op::p_minu,  Format::r,     kFunct7, word(kAlu, 5, 0x02)},
    {"p.max",   Op::p_max,   Format::r,     kFunct7, word(kAlu, 6, 0x02)},
    {"p.maxu",  Op::p_maxu,  Format::r,     kFunct7, word(kAlu, 7, 0x02)},
    {"p.exths", Op::p_exths, Format::unary, kFunct7NoRs2, word(kAlu, 4, 0x08)},
    {"p.exthz", Op::p_exthz, Format::unary, kFunct7NoRs2, word(kAlu, 5, 0x08)},
    {"p.extbs", Op::p_extbs, Format::unary, kFunct7NoRs2, word(kAlu, 6, 0x08)},
    {"p.extbz", Op::p_extbz, Format::unary, kFunct7NoRs2, word(kAlu, 7, 0x08)},
    {"p.clip",   Op::p_clip,  Format::clip, kFunct7, word(kAlu, 1, 0x0a)},
    {"p.clipu",  Op::p_clipu, Format::clip, kFunct7, word(kAlu, 2, 0x0a)},
    {"p.clipr",  Op::p_clip,  Format::r,    kFunct7, word(kAlu, 5, 0x0a)},
    {"p.clipur", Op::p_clipu, Format::r,    kFunct7, word(kAlu, 6, 0x0a)},
    // Bits
    {"p.extract",   Op::p_extract,  Format::bit_field, kTop2,   word(kAlu, 0, 0x60)},
    {"p.extractu",  Op::p_extractu, Format::bit_field, kTop2,   word(kAlu, 1, 0x60)},
    {"p.insert",    Op::p_insert,   Format::bit_field, kTop2,   word(kAlu, 2, 0x60)},
    {"p.bclr",      Op::p_bclr,     Format::bit_field, kTop2,   word(kAlu, 3, 0x60)},
    {"p.bset",      Op::p_bset,     Format::bit_field, kTop2,   word(kAlu, 4, 0x60)},
    {"p.extractr",  Op::p_extract,  Format::r,         kFunct7, word(kAlu, 0, 0x40)},
    {"p.extractur", Op::p_extractu, Format::r,         kFunct7, word(kAlu, 1, 0x40)},
    {"p.insertr",   Op::p_insert,   Format::r,         kFunct7, word(kAlu, 2, 0x40)},
    {"p.bclrr",     Op::p_bclr,     Format::r,         kFunct7, word(kAlu, 3, 0x40)},
    {"p.bsetr",     Op::p_bset,     Format::r,         kFunct7, word(kAlu, 4, 0x40)},
    {"p.ff1", Op::p_ff1, Format::unary, kFunct7NoRs2, word(kAlu, 0, 0x08)},
    {"p.fl1", Op::p_fl1, Format::unary, kFunct7NoRs2, word(kAlu, 1, 0x08)},
    {"p.clb", Op::p_clb, Format::unary, kFunct7NoRs2, word(kAlu, 2, 0x08)},
    {"p.cnt", Op::p_cnt, Format::unary, kFunct7NoRs2, word(kAlu, 3, 0x08)},
    {"p.ror", Op::p_ror, Format::r,     kFunct7,      word(kAlu, 5, 0x04)},
    // Add, subtract, shift: bits 31:30 = unsigned, register form
    {"p.addN",    Op::p_addN,    Format::shifted, kTop2, word(kShifted, 2, 0x00)},
    {"p.adduN",   Op::p_adduN,   Format::shifted, kTop2, word(kShifted, 2, 0x40)},
    {"p.addRN",   Op::p_addRN,   Format::shifted, kTop2, word(kShifted, 6, 0x00)},
    {"p.adduRN",  Op::p_adduRN,  Format::shifted, kTop2, word(kShifted, 6, 0x40)},
    {"p.subN",    Op::p_subN,    Format::shifted, kTop2, word(kShifted, 3, 0x00)},
    {"p.subuN",   Op::p_subuN,   Format::shifted, kTop2, word(kShifted, 3, 0x40)},
    {"p.subRN",   Op::p_subRN,   Format::shifted, kTop2, word(kShifted, 7, 0x00)},
    {"p.subuRN",  Op::p_subuRN,  Format::shifted, kTop2, word(kShifted, 7, 0x40)},
    {"p.addNr",   Op::p_addNr,   Format::r, kFunct7, word(kShifted, 2, 0x20)},
    {"p.adduNr",  Op::p_adduNr,  Format::r, kFunct7, word(kShifted, 2, 0x60)},
    {"p.addRNr",  Op::p_addRNr,  Format::r, kFunct7, word(kShifted, 6, 0x20)},
    {"p.adduRNr", Op::p_adduRNr, Format::r, kFunct7, word(kShifted, 6, 0x60)},
    {"p.subNr",   Op::p_subNr,   Format::r, kFunct7, word(kShifted, 3, 0x20)},
    {"p.subuNr",  Op::p_subuNr,  Format::r, kFunct7, word(kShifted, 3, 0x60)},
    {"p.subRNr",  Op::p_subRNr,  Format::r, kFunct7, word(kShifted, 7, 0x20)},
    {"p.subuRNr", Op::p_subuRNr, Format::r, kFunct7, word(kShifted, 7, 0x60)},
    // Multiply, accumulate: of words; of halves, bits 31:30 = signed, high halves. Without a shift they have another name.
    {"p.mac", Op::p_mac, Format::r, kFunct7, word(kAlu, 0, 0x21)},
    {"p.msu", Op::p_msu, Format::r, kFunct7, word(kAlu, 1, 0x21)},
    {"p.muls",     Op::p_mulsN,    Format::r,             kFunct7, word(kShifted, 0, 0x40)},
    {"p.mulhhs",   Op::p_mulhhsN,  Format::r,             kFunct7, word(kShifted, 0, 0x60)},
    {"p.mulsN",    Op::p_mulsN,    Format::shifted_some,  kTop2,   word(kShifted, 0, 0x40)},
    {"p.mulhhsN",  Op::p_mulhhsN,  Format::shifted_some,  kTop2,   word(kShifted, 0, 0x60)},
    {"p.mulsRN",   Op::p_mulsRN,   Format::shifted,       kTop2,   word(kShifted, 4, 0x40)},
    {"p.mulhhsRN", Op::p_mulhhsRN, Format::shifted,       kTop2,   word(kShifted, 4, 0x60)},
    {"p.mulu",     Op::p_muluN,    Format::r,             kFunct7, word(kShifted, 0, 0x00)},
    {"p.mulhhu",   Op::p_mulhhuN,  Format::r,             kFunct7, word(kShifted, 0, 0x20)},
    {"p.muluN",    Op::p_muluN,    Format::shifted_some,  kTop2,   word(kShifted, 0, 0x00)},
    {"p.mulhhuN",  Op::p_mulhhuN,  Format::shifted_some,  kTop2,   word(kShifted, 0, 0x20)},
    {"p.muluRN",   Op::p_muluRN,   Format::shifted,       kTop2,   word(kShifted, 4, 0x00)},
    {"p.mulhhuRN", Op::p_mulhhuRN, Format::shifted,       kTop2,   word(kShifted, 4, 0x20)},
    {"p.macs",     Op::p_macsN,    Format::r,             kFunct7, word(kShifted, 1, 0x40)},
    {"p.machhs",   Op::p_machhsN,  Format::r,             kFunct7, word(kShifted, 1, 0x60)},
    {"p.macsN",    Op::p_macsN,    Format::shifted_some,  kTop2,   word(kShifted, 1, 0x40)},
    {"p.machhsN",  Op::p_machhsN,  Format::shifted_some,  kTop2,   word(kShifted, 1, 0x60)},
    {"p.macsRN",   Op::p_macsRN,   Format::shifted,       kTop2,   word(kShifted, 5, 0x40)},
    {"p.machhsRN", Op::p_machhsRN, Format::shifted,       kTop2,   word(kShifted, 5, 0x60)},
    {"p.macu",     Op::p_macuN,    Format::r,             kFunct7, word(kShifted, 1, 0x00)},
    {"p.machhu",   Op::p_machhuN,  Format::r,             kFunct7, word(kShifted, 1, 0x20)},
    {"p.macuN",    Op::p_macuN,    Format::shifted_some,  kTop2,   word(kShifted, 1, 0x00)},
    {"p.machhuN",  Op::p_machhuN,  Format::shifted_some,  kTop2,   word(kShifted, 1, 0x20)},
    {"p.macuRN",   Op::p_macuRN,   Format::shifted,       kTop2,   word(kShifted, 5, 0x00)},
    {"p.machhuRN", Op::p_machhuRN, Format::shifted,       kTop2,   word(kShifted, 5, 0x20)},
    // SIMD without scalar forms
    {"pv.abs.h", Op::pv_abs_h, Format::unary, kTop6NoRs2, word(kSimd, 0, 0x38)},
    {"pv.abs.b", Op::pv_abs_b, Format::unary, kTop6NoRs2, word(kSimd, 1, 0x38)},
    {"pv.extract.h",  Op::pv_extract_h,  Format::simd_lane, kTop6, word(kSimd, 6, 0x3c)},
    {"pv.extract.b",  Op::pv_extract_b,  Format::simd_lane, kTop6, word(kSimd, 7, 0x3c)},
    {"pv.extractu.h", Op::pv_extractu_h, Format::simd_lane, kTop6, word(kSimd, 6, 0x48)},
    {"pv.extractu.b", Op::pv_extractu_b, Format::simd_lane, kTop6, word(kSimd, 7, 0x48)},
    {"pv.insert.h",   Op::pv_insert_h,   Format::simd_lane, kTop6, word(kSimd, 6, 0x58)},
    {"pv.insert.b",   Op::pv_insert_b,   Format::simd_lane, kTop6, word(kSimd, 7, 0x58)},
    {"pv.shuffle.h",  Op::pv_shuffle_h,  Format::simd, kTop6, word(kSimd, 0, 0x60)},
    {"pv.shuffle.b",  Op::pv_shuffle_b,  Format::simd, kTop6, word(kSimd, 1, 0x60)},
    {"pv.shuffle.sci.h",   Op::pv_shuffle_h, Format::shuffle_h, kTop6, word(kSimd, 6, 0x60)},
    {"pv.shuffleI0.sci.b", Op::pv_shuffle_b, Format::shuffle_b, kTop6, word(kSimd, 7, 0x60)},
    {"pv.shuffleI1.sci.b", Op::pv_shuffle_b, Format::shuffle_b, kTop6, word(kSimd, 7, 0x74)},
    {"pv.shuffleI2.sci.b", Op::pv_shuffle_b, Format::shuffle_b, kTop6, word(kSimd, 7, 0x78)},
    {"pv.shuffleI3.sci.b", Op::pv_shuffle_b, Format::shuffle_b, kTop6, word(kSimd, 7, 0x7c)},
    {"pv.shuffle2.h", Op::pv_shuffle2_h, Format::simd, kTop6, word(kSimd, 0, 0x64)},
    {"pv.shuffle2.b", Op::pv_shuffle2_b, Format::simd, kTop6, word(kSimd, 1, 0x64)},
    {"pv.pack",       Op::pv_pack_h,     Format::simd, kTop6, word(kSimd, 0, 0x68)},
    {"pv.packhi.b",   Op::pv_packhi_b,   Format::simd, kTop6, word(kSimd, 1, 0x6c)},
    {"pv.packlo.b",   Op::pv_packlo_b,   Format::simd, kTop6, word(kSimd, 1, 0x70)},
});

/// A SIMD operation with all six forms: halves and bytes, each against a vector, a scalar and an immediate.
struct Family {
  std::string_view name;
  Op halves;  // bytes: the one after it
  std::uint32_t top6;
  bool immediate_is_signed;
};

inline constexpr auto kFamilies = std::to_array<Family>({
    {"pv.add",    Op::pv_add_h,    0x00, true},
    {"pv.sub",    Op::pv_sub_h,    0x02, true},
    {"pv.avg",    Op::pv_avg_h,    0x04, true},
    {"pv.avgu",   Op::pv_avgu_h,   0x06, false},
    {"pv.min",    Op::pv_min_h,    0x08, true},
    {"pv.minu",   Op::pv_minu_h,   0x0a, false},
    {"pv.max",    Op::pv_max_h,    0x0c, true},
    {"pv.maxu",   Op::pv_maxu_h,   0x0e, false},
    {"pv.srl",    Op::pv_srl_h,    0x10, false},
    {"pv.sra",    Op::pv_sra_h,    0x12, true},
    {"pv.sll",    Op::pv_sll_h,    0x14, false},
    {"pv.or",     Op::pv_or_h,     0x16, true},
    {"pv.xor",    Op::pv_xor_h,    0x18, true},
    {"pv.and",    Op::pv_and_h,    0x1a, true},
    {"pv.dotup",  Op::pv_dotup_h,  0x20, false},
    {"pv.dotusp", Op::pv_dotusp_h, 0x22, true},
    {"pv.dotsp",  Op::pv_dotsp_h,  0x26, true},
    {"pv.sdotup", Op::pv_sdotup_h, 0x28, false},
    {"pv.sdotusp", Op::pv_sdotusp_h, 0x2a, true},
    {"pv.sdotsp", Op::pv_sdotsp_h, 0x2e, true},
    {"pv.cmpeq",  Op::pv_cmpeq_h,  0x01, true},
    {"pv.cmpne",  Op::pv_cmpne_h,  0x03, true},
    {"pv.cmpgt",  Op::pv_cmpgt_h,  0x05, true},
    {"pv.cmpge",  Op::pv_cmpge_h,  0x07, true},
    {"pv.cmplt",  Op::pv_cmplt_h,  0x09, true},
    {"pv.cmple",  Op::pv_cmple_h,  0x0b, true},
    {"pv.cmpgtu", Op::pv_cmpgtu_h, 0x0d, false},
    {"pv.cmpgeu", Op::pv_cmpgeu_h, 0x0f, false},
    {"pv.cmpltu", Op::pv_cmpltu_h, 0x11, false},
    {"pv.cmpleu", Op::pv_cmpleu_h, 0x13, false},
});
// clang-format on

inline constexpr std::size_t kForms = 6;
inline constexpr std::size_t kRowCount = kScalarRows.size() + kFamilies.size() * kForms;

constexpr std::array<Encoding, kRowCount> rows() {
  std::array<Encoding, kRowCount> all{};
  std::size_t at = 0;
  for (const auto& row : kScalarRows) all[at++] = row;
  for (const auto& family : kFamilies) {
    const auto bytes = static_cast<Op>(static_cast<int>(family.halves) + 1);
    const auto immediate = family.immediate_is_signed ? Format::simd_imm : Format::simd_uimm;
    const auto add = [&](Op op, Format format, std::uint32_t funct3, std::string_view suffix) {
      all[at] = {family.name, op, format, kTop6, word(kSimd, funct3, family.top6 << 1)};
      all[at++].suffix = suffix;
    };
    add(family.halves, Format::simd, 0, ".h");
    add(family.halves, Format::simd_scalar, 4, ".sc.h");
    add(family.halves, immediate, 6, ".sci.h");
    add(bytes, Format::simd, 1, ".b");
    add(bytes, Format::simd_scalar, 5, ".sc.b");
    add(bytes, immediate, 7, ".sci.b");
  }
  for (auto& row : all) row.extension = Extension::xpulp;
  return all;
}

}  // namespace mebots::soc::xpulp
