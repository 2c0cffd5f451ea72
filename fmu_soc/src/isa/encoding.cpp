// SPDX-License-Identifier: Apache-2.0
#include "isa/encoding.hpp"

#include "isa/xpulp_encodings.hpp"

#include <algorithm>
#include <array>
#include <vector>

namespace mebots::soc {
namespace {

constexpr std::uint32_t kOpcode = 0x7f;
constexpr std::uint32_t kFunct3 = 0x707f;
constexpr std::uint32_t kFunct7 = 0xfe00707f;
constexpr std::uint32_t kAll = 0xffffffff;

// clang-format off
constexpr auto kStandardRows = std::to_array<Encoding>({
    // RV32I
    {"lui",    Op::lui,    Format::u,       kOpcode, 0x00000037},
    {"auipc",  Op::auipc,  Format::u,       kOpcode, 0x00000017},
    {"jal",    Op::jal,    Format::jal,     kOpcode, 0x0000006f},
    {"jalr",   Op::jalr,   Format::jalr,    kFunct3, 0x00000067},
    {"beq",    Op::beq,    Format::branch,  kFunct3, 0x00000063},
    {"bne",    Op::bne,    Format::branch,  kFunct3, 0x00001063},
    {"blt",    Op::blt,    Format::branch,  kFunct3, 0x00004063},
    {"bge",    Op::bge,    Format::branch,  kFunct3, 0x00005063},
    {"bltu",   Op::bltu,   Format::branch,  kFunct3, 0x00006063},
    {"bgeu",   Op::bgeu,   Format::branch,  kFunct3, 0x00007063},
    {"lb",     Op::lb,     Format::load,    kFunct3, 0x00000003},
    {"lh",     Op::lh,     Format::load,    kFunct3, 0x00001003},
    {"lw",     Op::lw,     Format::load,    kFunct3, 0x00002003},
    {"lbu",    Op::lbu,    Format::load,    kFunct3, 0x00004003},
    {"lhu",    Op::lhu,    Format::load,    kFunct3, 0x00005003},
    {"sb",     Op::sb,     Format::store,   kFunct3, 0x00000023},
    {"sh",     Op::sh,     Format::store,   kFunct3, 0x00001023},
    {"sw",     Op::sw,     Format::store,   kFunct3, 0x00002023},
    {"addi",   Op::addi,   Format::i,       kFunct3, 0x00000013},
    {"slti",   Op::slti,   Format::i,       kFunct3, 0x00002013},
    {"sltiu",  Op::sltiu,  Format::i,       kFunct3, 0x00003013},
    {"xori",   Op::xori,   Format::i,       kFunct3, 0x00004013},
    {"ori",    Op::ori,    Format::i,       kFunct3, 0x00006013},
    {"andi",   Op::andi,   Format::i,       kFunct3, 0x00007013},
    {"slli",   Op::slli,   Format::shift,   kFunct7, 0x00001013},
    {"srli",   Op::srli,   Format::shift,   kFunct7, 0x00005013},
    {"srai",   Op::srai,   Format::shift,   kFunct7, 0x40005013},
    {"add",    Op::add,    Format::r,       kFunct7, 0x00000033},
    {"sub",    Op::sub,    Format::r,       kFunct7, 0x40000033},
    {"sll",    Op::sll,    Format::r,       kFunct7, 0x00001033},
    {"slt",    Op::slt,    Format::r,       kFunct7, 0x00002033},
    {"sltu",   Op::sltu,   Format::r,       kFunct7, 0x00003033},
    {"xor",    Op::xor_,   Format::r,       kFunct7, 0x00004033},
    {"srl",    Op::srl,    Format::r,       kFunct7, 0x00005033},
    {"sra",    Op::sra,    Format::r,       kFunct7, 0x40005033},
    {"or",     Op::or_,    Format::r,       kFunct7, 0x00006033},
    {"and",    Op::and_,   Format::r,       kFunct7, 0x00007033},
    {"fence",  Op::fence,  Format::fence,   kFunct3, 0x0000000f},
    {"ecall",  Op::ecall,  Format::none,    kAll,    0x00000073},
    {"ebreak", Op::ebreak, Format::none,    kAll,    0x00100073},
    // M
    {"mul",    Op::mul,    Format::r,       kFunct7, 0x02000033},
    {"mulh",   Op::mulh,   Format::r,       kFunct7, 0x02001033},
    {"mulhsu", Op::mulhsu, Format::r,       kFunct7, 0x02002033},
    {"mulhu",  Op::mulhu,  Format::r,       kFunct7, 0x02003033},
    {"div",    Op::div,    Format::r,       kFunct7, 0x02004033},
    {"divu",   Op::divu,   Format::r,       kFunct7, 0x02005033},
    {"rem",    Op::rem,    Format::r,       kFunct7, 0x02006033},
    {"remu",   Op::remu,   Format::r,       kFunct7, 0x02007033},
    // Zifencei, Zicsr
    {"fence.i", Op::fence_i, Format::fence,  kFunct3, 0x0000100f},
    {"csrrw",  Op::csrrw,  Format::csr,     kFunct3, 0x00001073},
    {"csrrs",  Op::csrrs,  Format::csr,     kFunct3, 0x00002073},
    {"csrrc",  Op::csrrc,  Format::csr,     kFunct3, 0x00003073},
    {"csrrwi", Op::csrrwi, Format::csr_imm, kFunct3, 0x00005073},
    {"csrrsi", Op::csrrsi, Format::csr_imm, kFunct3, 0x00006073},
    {"csrrci", Op::csrrci, Format::csr_imm, kFunct3, 0x00007073},
    // Machine mode
    {"mret",   Op::mret,   Format::none,    kAll,    0x30200073},
    {"wfi",    Op::wfi,    Format::none,    kAll,    0x10500073},
    // C, quadrant 0
    {"c.addi4spn", Op::addi, Format::c_addi4spn, 0xe003, 0x0000},
    {"c.lw",       Op::lw,   Format::c_load,     0xe003, 0x4000},
    {"c.sw",       Op::sw,   Format::c_store,    0xe003, 0xc000},
    // C, quadrant 1
    {"c.addi",     Op::addi, Format::c_addi,     0xe003, 0x0001},
    {"c.jal",      Op::jal,  Format::c_jal,      0xe003, 0x2001},
    {"c.li",       Op::addi, Format::c_li,       0xe003, 0x4001},
    {"c.addi16sp", Op::addi, Format::c_addi16sp, 0xef83, 0x6101},
    {"c.lui",      Op::lui,  Format::c_lui,      0xe003, 0x6001},
    {"c.srli",     Op::srli, Format::c_shift,    0xec03, 0x8001},
    {"c.srai",     Op::srai, Format::c_shift,    0xec03, 0x8401},
    {"c.andi",     Op::andi, Format::c_andi,     0xec03, 0x8801},
    {"c.sub",      Op::sub,  Format::c_alu,      0xfc63, 0x8c01},
    {"c.xor",      Op::xor_, Format::c_alu,      0xfc63, 0x8c21},
    {"c.or",       Op::or_,  Format::c_alu,      0xfc63, 0x8c41},
    {"c.and",      Op::and_, Format::c_alu,      0xfc63, 0x8c61},
    {"c.j",        Op::jal,  Format::c_jump,     0xe003, 0xa001},
    {"c.beqz",     Op::beq,  Format::c_branch,   0xe003, 0xc001},
    {"c.bnez",     Op::bne,  Format::c_branch,   0xe003, 0xe001},
    // C, quadrant 2
    {"c.slli",     Op::slli, Format::c_slli,     0xe003, 0x0002},
    {"c.lwsp",     Op::lw,   Format::c_lwsp,     0xe003, 0x4002},
    {"c.jr",       Op::jalr, Format::c_jr,       0xf07f, 0x8002},
    {"c.mv",       Op::add,  Format::c_mv,       0xf003, 0x8002},
    {"c.ebreak",   Op::ebreak, Format::c_none,   0xffff, 0x9002},
    {"c.jalr",     Op::jalr, Format::c_jalr,     0xf07f, 0x9002},
    {"c.add",      Op::add,  Format::c_add,      0xf003, 0x9002},
    {"c.swsp",     Op::sw,   Format::c_swsp,     0xe003, 0xc002},
});
// clang-format on

constexpr auto all_rows() {
  constexpr auto kXpulpRows = xpulp::rows();
  std::array<Encoding, kStandardRows.size() + kXpulpRows.size()> rows{};
  std::copy(kXpulpRows.begin(), kXpulpRows.end(), std::copy(kStandardRows.begin(), kStandardRows.end(), rows.begin()));
  return rows;
}

constexpr auto kEncodings = all_rows();

/// Bits [high:low] of a word, moved to bit `to`.
constexpr std::uint32_t field(std::uint32_t word, unsigned high, unsigned low, unsigned to = 0) {
  return ((word >> low) & ((1U << (high - low + 1)) - 1U)) << to;
}

/// Copies bit `sign` of a value into all bits above it.
constexpr std::int32_t sign_extend(std::uint32_t value, unsigned sign) {
  return static_cast<std::int32_t>(value << (31 - sign)) >> (31 - sign);
}

constexpr std::int32_t immediate(Format format, std::uint32_t w) {
  switch (format) {
    case Format::i:
    case Format::load:
    case Format::load_post:
    case Format::jalr:
      return sign_extend(field(w, 31, 20), 11);
    case Format::clip:
    case Format::shift:
      return static_cast<std::int32_t>(field(w, 24, 20));
    case Format::store:
    case Format::store_post:
      return sign_extend(field(w, 31, 25, 5) | field(w, 11, 7), 11);
    case Format::branch:
    case Format::branch_imm:
      return sign_extend(field(w, 31, 31, 12) | field(w, 7, 7, 11) | field(w, 30, 25, 5) | field(w, 11, 8, 1), 12);
    case Format::u:
      return static_cast<std::int32_t>(w & 0xfffff000U);
    case Format::jal:
      return sign_extend(field(w, 31, 31, 20) | field(w, 19, 12, 12) | field(w, 20, 20, 11) | field(w, 30, 21, 1), 20);
    case Format::csr:
    case Format::csr_imm:
    case Format::loop_counti:
      return static_cast<std::int32_t>(field(w, 31, 20));
    case Format::loop_target:
    case Format::loop_setup:
      return static_cast<std::int32_t>(field(w, 31, 20, 1));
    case Format::loop_setupi:
      return static_cast<std::int32_t>(field(w, 31, 20) | field(w, 19, 15, 17));
    case Format::bit_field:
      return static_cast<std::int32_t>(field(w, 29, 25, 5) | field(w, 24, 20));
    case Format::shifted:
    case Format::shifted_some:
      return static_cast<std::int32_t>(field(w, 29, 25));
    case Format::simd_imm:
      return sign_extend(field(w, 24, 20, 1) | field(w, 25, 25), 5);
    case Format::simd_uimm:
    case Format::simd_lane:
    case Format::shuffle_h:
      return static_cast<std::int32_t>(field(w, 24, 20, 1) | field(w, 25, 25));
    case Format::shuffle_b:
      return static_cast<std::int32_t>(field(w, 28, 27, 6) | field(w, 24, 20, 1) | field(w, 25, 25));
    case Format::c_addi4spn:
      return static_cast<std::int32_t>(field(w, 12, 11, 4) | field(w, 10, 7, 6) | field(w, 6, 6, 2) |
                                       field(w, 5, 5, 3));
    case Format::c_load:
    case Format::c_store:
      return static_cast<std::int32_t>(field(w, 12, 10, 3) | field(w, 6, 6, 2) | field(w, 5, 5, 6));
    case Format::c_addi:
    case Format::c_li:
    case Format::c_andi:
      return sign_extend(field(w, 12, 12, 5) | field(w, 6, 2), 5);
    case Format::c_jump:
    case Format::c_jal:
      return sign_extend(field(w, 12, 12, 11) | field(w, 11, 11, 4) | field(w, 10, 9, 8) | field(w, 8, 8, 10) |
                             field(w, 7, 7, 6) | field(w, 6, 6, 7) | field(w, 5, 3, 1) | field(w, 2, 2, 5),
                         11);
    case Format::c_addi16sp:
      return sign_extend(
          field(w, 12, 12, 9) | field(w, 6, 6, 4) | field(w, 5, 5, 6) | field(w, 4, 3, 7) | field(w, 2, 2, 5), 9);
    case Format::c_lui:
      return sign_extend(field(w, 12, 12, 17) | field(w, 6, 2, 12), 17);
    case Format::c_shift:
    case Format::c_slli:
      return static_cast<std::int32_t>(field(w, 12, 12, 5) | field(w, 6, 2));
    case Format::c_branch:
      return sign_extend(
          field(w, 12, 12, 8) | field(w, 11, 10, 3) | field(w, 6, 5, 6) | field(w, 4, 3, 1) | field(w, 2, 2, 5), 8);
    case Format::c_lwsp:
      return static_cast<std::int32_t>(field(w, 12, 12, 5) | field(w, 6, 4, 2) | field(w, 3, 2, 6));
    case Format::c_swsp:
      return static_cast<std::int32_t>(field(w, 12, 9, 2) | field(w, 8, 7, 6));
    default:
      return 0;
  }
}

struct Registers {
  std::uint8_t rd = 0;
  std::uint8_t rs1 = 0;
  std::uint8_t rs2 = 0;
};

constexpr Registers registers(Format format, std::uint32_t w) {
  const auto full = [w](unsigned low) { return static_cast<std::uint8_t>(field(w, low + 4, low)); };
  const auto prime = [w](unsigned low) { return static_cast<std::uint8_t>(8 + field(w, low + 2, low)); };
  switch (format) {
    case Format::r:
    case Format::load_reg:
    case Format::load_post_reg:
    case Format::shifted:
    case Format::shifted_some:
    case Format::simd:
    case Format::simd_scalar:
      return {full(7), full(15), full(20)};
    case Format::unary:
    case Format::load_post:
    case Format::clip:
    case Format::bit_field:
    case Format::simd_imm:
    case Format::simd_uimm:
    case Format::simd_lane:
    case Format::shuffle_h:
    case Format::shuffle_b:
      return {full(7), full(15), 0};
    case Format::loop_target:
    case Format::loop_counti:
    case Format::loop_setupi:
      return {0, 0, static_cast<std::uint8_t>(field(w, 7, 7))};
    case Format::loop_count:
    case Format::loop_setup:
      return {0, full(15), static_cast<std::uint8_t>(field(w, 7, 7))};
    case Format::i:
    case Format::shift:
    case Format::load:
    case Format::jalr:
    case Format::csr:
    case Format::csr_imm:
      return {full(7), full(15), 0};
    case Format::store:
    case Format::branch:
    case Format::store_reg:
    case Format::store_post:
    case Format::store_post_reg:
    case Format::branch_imm:
      return {0, full(15), full(20)};
    case Format::u:
    case Format::jal:
      return {full(7), 0, 0};
    case Format::c_addi4spn:
      return {prime(2), 2, 0};
    case Format::c_load:
      return {prime(2), prime(7), 0};
    case Format::c_store:
      return {0, prime(7), prime(2)};
    case Format::c_addi:
    case Format::c_slli:
      return {full(7), full(7), 0};
    case Format::c_jal:
      return {1, 0, 0};
    case Format::c_li:
    case Format::c_lui:
      return {full(7), 0, 0};
    case Format::c_addi16sp:
      return {2, 2, 0};
    case Format::c_shift:
    case Format::c_andi:
      return {prime(7), prime(7), 0};
    case Format::c_alu:
      return {prime(7), prime(7), prime(2)};
    case Format::c_branch:
      return {0, prime(7), 0};
    case Format::c_lwsp:
      return {full(7), 2, 0};
    case Format::c_swsp:
      return {0, 2, full(2)};
    case Format::c_jr:
      return {0, full(7), 0};
    case Format::c_jalr:
      return {1, full(7), 0};
    case Format::c_mv:
      return {full(7), 0, full(2)};
    case Format::c_add:
      return {full(7), full(7), full(2)};
    default:
      return {};
  }
}

constexpr Operand operand_of(Format format) {
  switch (format) {
    case Format::simd_scalar:
      return Operand::scalar;
    case Format::simd_imm:
    case Format::simd_uimm:
    case Format::simd_lane:
    case Format::shuffle_h:
    case Format::shuffle_b:
    case Format::clip:
    case Format::bit_field:
      return Operand::immediate;
    default:
      return Operand::reg;
  }
}

constexpr std::uint8_t third_register(const Encoding& encoding, std::uint32_t w) {
  const bool offset = is_store(encoding.op) && has_register_offset(encoding.format);
  return offset || reads_rd(encoding.op) ? static_cast<std::uint8_t>(field(w, 11, 7)) : std::uint8_t{0};
}

/// Rows that can match a word, by its low bits: opcode (32 bits long) or quadrant and funct3 (16 bits long).
class Index {
 public:
  Index() {
    for (const auto& encoding : kEncodings) {
      if (is_compressed(encoding.format)) {
        compressed_[compressed_key(encoding.match)].push_back(&encoding);
      } else {
        full_[encoding.match & 0x7fU].push_back(&encoding);
      }
    }
  }

  const std::vector<const Encoding*>& candidates(std::uint32_t word) const {
    return is_compressed(word) ? compressed_[compressed_key(word)] : full_[word & 0x7fU];
  }

 private:
  static std::uint32_t compressed_key(std::uint32_t word) { return field(word, 15, 13, 2) | (word & 3U); }

  std::array<std::vector<const Encoding*>, 128> full_;
  std::array<std::vector<const Encoding*>, 32> compressed_;
};

}  // namespace

std::span<const Encoding> encodings() {
  return kEncodings;
}

bool is_reserved(const Encoding& encoding, std::uint32_t word) {
  const auto format = encoding.format;
  const auto rd = field(word, 11, 7);
  switch (format) {
    case Format::c_addi4spn:
    case Format::c_addi16sp:
      return immediate(format, word) == 0;
    case Format::c_lui:
      return rd == 2 || immediate(format, word) == 0;  // rd 2 is c.addi16sp
    case Format::c_shift:
    case Format::c_slli:
      return immediate(format, word) > 31;
    case Format::c_lwsp:
    case Format::c_jr:
    case Format::c_jalr:
      return rd == 0;
    case Format::c_mv:
    case Format::c_add:
      return field(word, 6, 2) == 0;  // c.jr, c.jalr, c.ebreak
    case Format::shifted_some:
      return immediate(format, word) == 0;
    default:
      return false;
  }
}

Decoded decode(std::uint32_t word, Extension most) {
  static const Index index;
  Decoded decoded;
  if (is_compressed(word)) {
    word &= 0xffffU;
    decoded.length = 2;
  }
  for (const auto* encoding : index.candidates(word)) {
    if ((word & encoding->mask) != encoding->match || encoding->extension > most) continue;
    if (is_reserved(*encoding, word)) continue;
    const auto fields = registers(encoding->format, word);
    decoded.op = encoding->op;
    decoded.rd = fields.rd;
    decoded.rs1 = fields.rs1;
    decoded.rs2 = fields.rs2;
    decoded.rs3 = third_register(*encoding, word);
    decoded.operand = operand_of(encoding->format);
    decoded.imm = immediate(encoding->format, word);
    decoded.encoding = encoding;
    return decoded;
  }
  decoded.imm = static_cast<std::int32_t>(word);  // for mtval
  return decoded;
}

std::int32_t operand_value(const Decoded& decoded) {
  if (decoded.operand != Operand::immediate) return decoded.imm;
  const auto value = static_cast<std::uint32_t>(decoded.imm);
  // Selectors of a shuffle, from the highest part down; each part's bits stand at the foot of the part.
  switch (decoded.encoding->format) {
    case Format::clip:
      return static_cast<std::int32_t>(((1U << value) - 1U) >> 1);
    case Format::shuffle_h:
      return static_cast<std::int32_t>(field(value, 1, 1, 16) | field(value, 0, 0));
    case Format::shuffle_b:
      return static_cast<std::int32_t>(field(value, 7, 6, 24) | field(value, 5, 4, 16) | field(value, 3, 2, 8) |
                                       field(value, 1, 0));
    case Format::simd_imm:
    case Format::simd_uimm: {
      const bool bytes = (decoded.encoding->match >> 12 & 1U) != 0;
      return static_cast<std::int32_t>(bytes ? (value & 0xffU) * 0x01010101U : (value & 0xffffU) * 0x00010001U);
    }
    default:
      return decoded.imm;
  }
}

}  // namespace mebots::soc
