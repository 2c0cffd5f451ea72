// SPDX-License-Identifier: Apache-2.0
#include "isa/encoding.hpp"

#include <array>
#include <cstddef>
#include <vector>

namespace mebots::soc {
namespace {

constexpr auto kEncodings = std::to_array<Encoding>({
#include "fmu_soc_isa/encodings.inc"
});

/// Returns the third register that an instruction reads: for an accumulation, the destination register; for a store,
/// the register with the offset.
std::uint8_t third_register(const Encoding& encoding, std::uint32_t w) {
  const auto& format = row_of(encoding.format);
  return (reads_rd(encoding.op) ? format.rd : format.rs3).of(w);
}

/// Finds the rows of the table that may match a word by its low bits: the opcode of a 32-bit instruction, or quadrant
/// and funct3 of a 16-bit instruction.
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

const Index kIndex;

}  // namespace

std::span<const Encoding> encodings() {
  return kEncodings;
}

bool is_reserved(const Encoding& encoding, std::uint32_t word) {
  const auto& format = row_of(encoding.format);
  const auto at_7 = field(word, 11, 7);
  switch (format.reserved) {
    case Reserved::never:
      return false;
    case Reserved::zero_immediate:
      return format.immediate.of(word) == 0;
    case Reserved::zero_immediate_or_sp:
      return format.immediate.of(word) == 0 || at_7 == 2;
    case Reserved::long_shift:
      return format.immediate.of(word) > 31;
    case Reserved::zero_at_7:
      return at_7 == 0;
    case Reserved::zero_at_2:
      return field(word, 6, 2) == 0;
    case Reserved::rounding:
      return field(word, 14, 12) == 5 || field(word, 14, 12) == 6;
  }
  return false;
}

Decoded decode(std::uint32_t word, Extensions has) {
  Decoded decoded;
  if (is_compressed(word)) {
    word &= 0xffffU;
    decoded.length = 2;
  }
  for (const auto* encoding : kIndex.candidates(word)) {
    if ((word & encoding->mask) != encoding->match || !has.has(encoding->extension)) continue;
    if (is_reserved(*encoding, word)) continue;
    const auto& format = row_of(encoding->format);
    decoded.op = encoding->op;
    decoded.rd = format.rd.of(word);
    decoded.rs1 = format.rs1.of(word);
    decoded.rs2 = format.rs2.of(word);
    decoded.rs3 = third_register(*encoding, word);
    decoded.operand = format.operand;
    decoded.imm = format.immediate.of(word);
    decoded.encoding = encoding;
    return decoded;
  }
  decoded.imm = static_cast<std::int32_t>(word);  // becomes the value of mtval
  return decoded;
}

std::int32_t operand_value(const Decoded& decoded) {
  if (decoded.operand != Operand::immediate) return decoded.imm;
  const auto value = static_cast<std::uint32_t>(decoded.imm);
  // The immediate of a shuffle contains a selector for each part of the result. Each selector is moved to the lowest
  // bits of this part.
  switch (row_of(decoded.encoding->format).value) {
    case Value::as_it_is:
      return decoded.imm;
    case Value::bound:
      return static_cast<std::int32_t>(((1U << value) - 1U) >> 1);
    case Value::in_all_parts: {
      const bool bytes = traits_of(decoded.op).parts == 4;
      return static_cast<std::int32_t>(bytes ? (value & 0xffU) * 0x01010101U : (value & 0xffffU) * 0x00010001U);
    }
    case Value::selects_halves:
      return static_cast<std::int32_t>(field(value, 1, 1, 16) | field(value, 0, 0));
    case Value::selects_bytes:
      return static_cast<std::int32_t>(field(value, 7, 6, 24) | field(value, 5, 4, 16) | field(value, 3, 2, 8) |
                                       field(value, 1, 0));
  }
  return decoded.imm;
}

}  // namespace mebots::soc
