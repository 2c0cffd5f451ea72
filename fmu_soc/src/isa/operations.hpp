// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

/// What the computing instructions compute: one tiny function each, on 32-bit register values.
/// Source: The RISC-V Instruction Set Manual, volume I, chapters 2 and 7.
namespace mebots::soc::operations {

using Word = std::uint32_t;

constexpr std::int32_t as_signed(Word a) {
  return static_cast<std::int32_t>(a);
}

constexpr Word add(Word a, Word b) {
  return a + b;
}
constexpr Word sub(Word a, Word b) {
  return a - b;
}
constexpr Word sll(Word a, Word b) {
  return a << (b & 31U);
}
constexpr Word slt(Word a, Word b) {
  return as_signed(a) < as_signed(b) ? 1U : 0U;
}
constexpr Word sltu(Word a, Word b) {
  return a < b ? 1U : 0U;
}
constexpr Word bit_xor(Word a, Word b) {
  return a ^ b;
}
constexpr Word srl(Word a, Word b) {
  return a >> (b & 31U);
}
constexpr Word sra(Word a, Word b) {
  return static_cast<Word>(as_signed(a) >> (b & 31U));
}
constexpr Word bit_or(Word a, Word b) {
  return a | b;
}
constexpr Word bit_and(Word a, Word b) {
  return a & b;
}

constexpr Word mul(Word a, Word b) {
  return a * b;
}
constexpr Word mulh(Word a, Word b) {
  return static_cast<Word>((std::int64_t{as_signed(a)} * std::int64_t{as_signed(b)}) >> 32);
}
constexpr Word mulhsu(Word a, Word b) {
  return static_cast<Word>((std::int64_t{as_signed(a)} * static_cast<std::int64_t>(b)) >> 32);
}
constexpr Word mulhu(Word a, Word b) {
  return static_cast<Word>((std::uint64_t{a} * std::uint64_t{b}) >> 32);
}

/// Division by zero gives all ones; the one overflow, -2^31 / -1, gives -2^31.
constexpr Word div(Word a, Word b) {
  if (b == 0) return ~Word{0};
  if (b == ~Word{0}) return Word{0} - a;
  return static_cast<Word>(as_signed(a) / as_signed(b));
}
constexpr Word divu(Word a, Word b) {
  return b == 0 ? ~Word{0} : a / b;
}
/// The remainder by zero is the dividend; of the overflow, 0.
constexpr Word rem(Word a, Word b) {
  if (b == 0) return a;
  if (b == ~Word{0}) return 0;
  return static_cast<Word>(as_signed(a) % as_signed(b));
}
constexpr Word remu(Word a, Word b) {
  return b == 0 ? a : a % b;
}

constexpr bool equal(Word a, Word b) {
  return a == b;
}
constexpr bool not_equal(Word a, Word b) {
  return a != b;
}
constexpr bool less(Word a, Word b) {
  return as_signed(a) < as_signed(b);
}
constexpr bool greater_equal(Word a, Word b) {
  return as_signed(a) >= as_signed(b);
}
constexpr bool less_unsigned(Word a, Word b) {
  return a < b;
}
constexpr bool greater_equal_unsigned(Word a, Word b) {
  return a >= b;
}

}  // namespace mebots::soc::operations
