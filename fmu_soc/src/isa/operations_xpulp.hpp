// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "isa/operations.hpp"

#include <bit>
#include <cstdint>

/// What the scalar instructions of Xpulp v2 compute.
/// Sources: RI5CY user manual 4.45 chapter 14. Corners that it leaves open (sums that wrap, bit fields that pass the
/// end, negative bounds of a clip) as the ALU and multiplier of RI5CY's RTL do them (pulp-platform/riscv, February
/// 2018).
namespace mebots::soc::operations {

constexpr Word abs(Word a) {
  return as_signed(a) < 0 ? Word{0} - a : a;  // of -2^31: itself
}
constexpr Word slet(Word a, Word b) {
  return as_signed(a) <= as_signed(b) ? 1U : 0U;
}
constexpr Word sletu(Word a, Word b) {
  return a <= b ? 1U : 0U;
}
constexpr Word min(Word a, Word b) {
  return as_signed(a) < as_signed(b) ? a : b;
}
constexpr Word minu(Word a, Word b) {
  return a < b ? a : b;
}
constexpr Word max(Word a, Word b) {
  return as_signed(a) > as_signed(b) ? a : b;
}
constexpr Word maxu(Word a, Word b) {
  return a > b ? a : b;
}
constexpr Word exths(Word a) {
  return static_cast<Word>(static_cast<std::int16_t>(a));
}
constexpr Word exthz(Word a) {
  return a & 0xffffU;
}
constexpr Word extbs(Word a) {
  return static_cast<Word>(static_cast<std::int8_t>(a));
}
constexpr Word extbz(Word a) {
  return a & 0xffU;
}

/// Into [-bound - 1, bound].
constexpr Word clip(Word a, Word bound) {
  if (as_signed(a) > as_signed(bound)) return bound;
  return std::int64_t{as_signed(a)} + as_signed(bound) + 1 < 0 ? ~bound : a;
}
/// Into [0, bound].
constexpr Word clipu(Word a, Word bound) {
  if (as_signed(a) > as_signed(bound)) return bound;
  return as_signed(a) < 0 ? 0U : a;
}

/// Half of the last place that a shift drops.
constexpr Word rounding(Word shift) {
  return (Word{1} << shift) >> 1;
}
// NOLINTBEGIN(readability-identifier-naming): as the instructions are called
constexpr Word addN(Word a, Word b, Word shift) {
  return sra(a + b, shift);
}
constexpr Word adduN(Word a, Word b, Word shift) {
  return srl(a + b, shift);
}
constexpr Word addRN(Word a, Word b, Word shift) {
  return sra(a + b + rounding(shift), shift);
}
constexpr Word adduRN(Word a, Word b, Word shift) {
  return srl(a + b + rounding(shift), shift);
}
constexpr Word subN(Word a, Word b, Word shift) {
  return sra(a - b, shift);
}
constexpr Word subuN(Word a, Word b, Word shift) {
  return srl(a - b, shift);
}
constexpr Word subRN(Word a, Word b, Word shift) {
  return sra(a - b + rounding(shift), shift);
}
constexpr Word subuRN(Word a, Word b, Word shift) {
  return srl(a - b + rounding(shift), shift);
}
// NOLINTEND(readability-identifier-naming)

/// A bit field is width - 1 << 5 | position. Its mask at position 0:
constexpr Word field_mask(Word bits) {
  return ~(0xfffffffeU << (bits >> 5 & 31U));
}
constexpr Word extractu(Word a, Word bits) {
  return (a >> (bits & 31U)) & field_mask(bits);
}
/// What passes the end of the word is filled with its sign.
constexpr Word extract(Word a, Word bits) {
  const auto shifted = sra(a, bits);
  const auto mask = field_mask(bits);
  return (shifted >> (bits >> 5 & 31U) & 1U) != 0 ? shifted | ~mask : shifted & mask;
}
/// `into` with the low bits of `a` in the field.
constexpr Word insert(Word into, Word a, Word bits) {
  const auto mask = field_mask(bits) << (bits & 31U);
  return (into & ~mask) | ((a << (bits & 31U)) & mask);
}
constexpr Word bclr(Word a, Word bits) {
  return a & ~(field_mask(bits) << (bits & 31U));
}
constexpr Word bset(Word a, Word bits) {
  return a | (field_mask(bits) << (bits & 31U));
}
/// Position of the lowest one; 32 when there is none.
constexpr Word ff1(Word a) {
  return static_cast<Word>(std::countr_zero(a));
}
/// Position of the highest one; 32 when there is none.
constexpr Word fl1(Word a) {
  return a == 0 ? 32U : 31U - static_cast<Word>(std::countl_zero(a));
}
/// Copies of the sign behind it; 0 for 0.
constexpr Word clb(Word a) {
  if (a == 0) return 0;
  return static_cast<Word>(as_signed(a) < 0 ? std::countl_one(a) : std::countl_zero(a)) - 1U;
}
constexpr Word cnt(Word a) {
  return static_cast<Word>(std::popcount(a));
}
constexpr Word ror(Word a, Word b) {
  return std::rotr(a, static_cast<int>(b & 31U));
}

constexpr Word mac(Word sum, Word a, Word b) {
  return sum + a * b;
}
constexpr Word msu(Word sum, Word a, Word b) {
  return sum - a * b;
}

/// Low and high halves of a word.
constexpr Word low_signed(Word a) {
  return exths(a);
}
constexpr Word high_signed(Word a) {
  return sra(a, 16);
}
constexpr Word low_unsigned(Word a) {
  return exthz(a);
}
constexpr Word high_unsigned(Word a) {
  return a >> 16;
}

/// sum + product of the halves that `Half` takes, shifted right by `Shift`; rounded first when `kRounds`.
template <auto Half, auto Shift, bool kRounds>
constexpr Word multiply_halves(Word sum, Word a, Word b, Word shift) {
  return Shift(sum + Half(a) * Half(b) + (kRounds ? rounding(shift) : 0U), shift);
}

}  // namespace mebots::soc::operations
