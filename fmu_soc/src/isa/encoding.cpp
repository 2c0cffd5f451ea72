// SPDX-License-Identifier: Apache-2.0
#include "isa/encoding.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <initializer_list>
#include <vector>

namespace mebots::soc {
namespace {

constexpr std::uint32_t kOpcode = 0x7f;
constexpr std::uint32_t kFunct3 = 0x707f;
constexpr std::uint32_t kFunct7 = 0xfe00707f;
constexpr std::uint32_t kAll = 0xffffffff;

// Of Xpulp: major opcodes, and which bits of a word say what it is.
constexpr std::uint32_t kLoad = 0x03;
constexpr std::uint32_t kLoadPost = 0x0b;
constexpr std::uint32_t kStore = 0x23;
constexpr std::uint32_t kStorePost = 0x2b;
constexpr std::uint32_t kAlu = 0x33;
constexpr std::uint32_t kSimd = 0x57;
constexpr std::uint32_t kShifted = 0x5b;
constexpr std::uint32_t kBranch = 0x63;
constexpr std::uint32_t kLoop = 0x7b;

constexpr std::uint32_t word(std::uint32_t opcode, std::uint32_t funct3, std::uint32_t funct7 = 0) {
  return opcode | funct3 << 12 | funct7 << 25;
}

constexpr std::uint32_t kFunct7NoRs2 = 0xfff0707f;  // rs2 = 0
constexpr std::uint32_t kTop2 = 0xc000707f;         // bits 31:30
constexpr std::uint32_t kTop6 = 0xfc00707f;         // bits 31:26
constexpr std::uint32_t kTop6NoRs2 = 0xfdf0707f;
constexpr std::uint32_t kLoopMask = 0x00007f7f;  // funct3 and bits 11:8

/// An encoding as it stands in the row of its operation.
struct Form {
  std::string_view name;
  Format format;
  std::uint32_t mask;
  std::uint32_t match;
};

/// The encodings of one operation.
struct Forms {
  static constexpr std::size_t kMost = 8;

  std::array<Encoding, kMost> encodings{};
  std::size_t count = 0;
};

constexpr Forms forms_of(Op op, Extension extension, std::initializer_list<Form> list) {
  Forms forms;
  for (const auto& form : list) {
    forms.encodings[forms.count++] = {form.name, op, form.format, form.mask, form.match, extension};
  }
  return forms;
}

constexpr auto kForms = std::to_array<Forms>({
#define MEBOTS_OP(name, traits, meaning, translation, ...) forms_of(Op::name, Extension::standard, {__VA_ARGS__}),
#define MEBOTS_XPULP(name, traits, meaning, translation, ...) forms_of(Op::name, Extension::xpulp, {__VA_ARGS__}),
#include "isa/instructions.inc"
});

constexpr std::size_t count_encodings() {
  std::size_t count = 0;
  for (const auto& forms : kForms) count += forms.count;
  return count;
}

constexpr auto all_encodings() {
  std::array<Encoding, count_encodings()> all{};
  std::size_t at = 0;
  for (const auto& forms : kForms) {
    for (std::size_t i = 0; i < forms.count; ++i) all[at++] = forms.encodings[i];
  }
  return all;
}

constexpr auto kEncodings = all_encodings();

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
