// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string_view>

namespace mebots::soc {

/// The layout of an encoding's operands. Formats that start with `c` are 16 bits long.
enum class Format : std::uint8_t {
#include "fmu_soc_isa/format_enum.inc"
};

/// The source of an operation's second operand.
enum class Operand : std::uint8_t {
  reg,        // register rs2
  scalar,     // low half or byte of register rs2, copied to all parts
  immediate,  // the immediate
};

/// Returns bits [high:low] of a word, moved to bit `to`.
constexpr std::uint32_t field(std::uint32_t word, unsigned high, unsigned low, unsigned to = 0) {
  return ((word >> low) & ((1U << (high - low + 1)) - 1U)) << to;
}

/// The bits of a word that contain the number of a register.
struct RegisterField {
  std::uint8_t low = 0;   // lowest bit
  std::uint8_t bits = 0;  // number of bits; 0 = the number is always `add`
  std::uint8_t add = 0;

  constexpr std::uint8_t of(std::uint32_t word) const {
    return static_cast<std::uint8_t>(bits == 0 ? add : add + field(word, low + bits - 1U, low));
  }
};

/// The bits of a word that form an immediate.
struct Immediate {
  struct Piece {
    std::uint8_t high;
    std::uint8_t low;
    std::uint8_t to = 0;  // bit of the immediate to which the lowest bit of the piece is moved
  };
  static constexpr std::uint8_t kUnsigned = 31;
  static constexpr std::size_t kMostPieces = 8;

  constexpr Immediate() = default;
  constexpr Immediate(std::initializer_list<Piece> list, std::uint8_t sign_bit = kUnsigned) : sign(sign_bit) {
    for (const auto& piece : list) pieces[count++] = piece;
  }

  std::array<Piece, kMostPieces> pieces{};
  std::size_t count = 0;
  std::uint8_t sign = kUnsigned;  // bit of the immediate that is copied to all higher bits

  constexpr std::int32_t of(std::uint32_t word) const {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < count; ++i) value |= field(word, pieces[i].high, pieces[i].low, pieces[i].to);
    return static_cast<std::int32_t>(value << (31 - sign)) >> (31 - sign);
  }
};

/// The conversion of an immediate to the second operand.
enum class Value : std::uint8_t {
  as_it_is,
  bound,           // clip: the immediate is the number of bits
  in_all_parts,    // SIMD: the immediate is copied to all parts
  selects_halves,  // shuffle: one bit for each half, from the highest half to the lowest
  selects_bytes,
};

/// The condition under which an encoding is reserved or belongs to another instruction.
enum class Reserved : std::uint8_t {
  never,
  zero_immediate,
  zero_immediate_or_sp,  // rd = x2
  long_shift,            // the shift amount is 32 or more
  zero_at_7,             // bits 11:7 contain x0
  zero_at_2,             // bits 6:2 contain x0
  rounding,              // bits 14:12 contain no valid rounding mode
};

/// A format of isa/formats.decode.
struct FormatRow {
  std::uint8_t bytes = 4;
  RegisterField rd{};
  RegisterField rs1{};
  RegisterField rs2{};
  RegisterField rs3{};
  Immediate immediate{};
  Operand operand = Operand::reg;  // source of the second operand
  Value value = Value::as_it_is;
  Reserved reserved = Reserved::never;
  std::string_view text{};  // assembly text of the operands; disassembly.cpp replaces the names in braces
};

namespace format_rows {

inline constexpr auto kRows = std::to_array<FormatRow>({
#include "fmu_soc_isa/format_rows.inc"
});

}  // namespace format_rows

constexpr const FormatRow& row_of(Format format) {
  return format_rows::kRows[static_cast<std::size_t>(format)];
}
constexpr bool is_compressed(Format format) {
  return row_of(format).bytes == 2;
}

}  // namespace mebots::soc
