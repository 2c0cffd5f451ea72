// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "isa/operations_xpulp.hpp"

#include <cstdint>
#include <type_traits>

/// What the SIMD instructions of Xpulp v2 compute, on two halves or four bytes of a word. Part 0 is the lowest.
/// Sources: as operations_xpulp.hpp.
namespace mebots::soc::operations {

/// The type of a part: std::int16_t or std::uint16_t for halves, std::int8_t or std::uint8_t for bytes.
template <typename T>
inline constexpr unsigned kParts = 4 / sizeof(T);
template <typename T>
inline constexpr unsigned kPartBits = 8 * sizeof(T);

template <typename T>
constexpr T part(Word a, unsigned index) {
  return static_cast<T>(a >> (index * kPartBits<T>));
}
template <typename T>
constexpr Word at_part(T value, unsigned index) {
  return Word{static_cast<std::make_unsigned_t<T>>(value)} << (index * kPartBits<T>);
}

/// The low part of a word in all its parts.
template <typename T>
constexpr Word in_all_parts(Word a) {
  return Word{static_cast<std::make_unsigned_t<T>>(a)} * (sizeof(T) == 1 ? 0x01010101U : 0x00010001U);
}

/// `Compute` on each pair of parts.
template <typename T, auto Compute>
constexpr Word simd(Word a, Word b) {
  Word result = 0;
  for (unsigned i = 0; i < kParts<T>; ++i) {
    result |= at_part<T>(static_cast<T>(Compute(part<T>(a, i), part<T>(b, i))), i);
  }
  return result;
}

namespace parts {
inline constexpr auto kAdd = [](auto a, auto b) { return a + b; };
inline constexpr auto kSub = [](auto a, auto b) { return a - b; };
/// Half of the sum, which wraps before it is halved.
inline constexpr auto kAverage = [](auto a, auto b) { return static_cast<decltype(a)>(a + b) >> 1; };
inline constexpr auto kMin = [](auto a, auto b) { return a < b ? a : b; };
inline constexpr auto kMax = [](auto a, auto b) { return a > b ? a : b; };
inline constexpr auto kShiftRight = [](auto a, auto b) { return a >> (static_cast<unsigned>(b) % (8 * sizeof(a))); };
inline constexpr auto kShiftLeft = [](auto a, auto b) {
  return static_cast<unsigned>(a) << (static_cast<unsigned>(b) % (8 * sizeof(a)));
};
// A comparison that holds gives all ones.
inline constexpr auto kEqual = [](auto a, auto b) { return a == b ? -1 : 0; };
inline constexpr auto kNotEqual = [](auto a, auto b) { return a != b ? -1 : 0; };
inline constexpr auto kGreater = [](auto a, auto b) { return a > b ? -1 : 0; };
inline constexpr auto kGreaterEqual = [](auto a, auto b) { return a >= b ? -1 : 0; };
inline constexpr auto kLess = [](auto a, auto b) { return a < b ? -1 : 0; };
inline constexpr auto kLessEqual = [](auto a, auto b) { return a <= b ? -1 : 0; };
}  // namespace parts

template <typename T>
constexpr Word simd_abs(Word a) {
  Word result = 0;
  for (unsigned i = 0; i < kParts<T>; ++i) {
    const auto value = part<T>(a, i);
    result |= at_part<T>(static_cast<T>(value < 0 ? -value : value), i);
  }
  return result;
}

/// sum + the products of all pairs of parts.
template <typename A, typename B>
constexpr Word dot(Word sum, Word a, Word b) {
  for (unsigned i = 0; i < kParts<A>; ++i) {
    sum += static_cast<Word>(std::int32_t{part<A>(a, i)}) * static_cast<Word>(std::int32_t{part<B>(b, i)});
  }
  return sum;
}
template <typename A, typename B>
constexpr Word dot(Word a, Word b) {
  return dot<A, B>(0, a, b);
}

/// One part, extended by its sign or by zeros.
template <typename T>
constexpr Word extract_part(Word a, Word index) {
  return static_cast<Word>(std::int32_t{part<T>(a, index % kParts<T>)});
}
/// `into` with the low part of `a` in place of one of its own.
template <typename T>
constexpr Word insert_part(Word into, Word a, Word index) {
  const auto place = index % kParts<T>;
  return (into & ~at_part<T>(static_cast<T>(-1), place)) | at_part<T>(static_cast<T>(a), place);
}

/// Each part of `selectors` says which part of `a` stands there.
template <typename T>
constexpr Word shuffle(Word a, Word selectors) {
  Word result = 0;
  for (unsigned i = 0; i < kParts<T>; ++i) {
    result |= at_part<T>(part<T>(a, part<T>(selectors, i) % kParts<T>), i);
  }
  return result;
}
/// Likewise out of the parts of two words: `low`, then `high`.
template <typename T>
constexpr Word shuffle2(Word low, Word high, Word selectors) {
  Word result = 0;
  for (unsigned i = 0; i < kParts<T>; ++i) {
    const auto selector = part<T>(selectors, i);
    const auto from = (selector & kParts<T>) != 0 ? high : low;
    result |= at_part<T>(part<T>(from, selector % kParts<T>), i);
  }
  return result;
}

/// The low halves of two words: of `a` above, of `b` below.
constexpr Word pack(Word a, Word b) {
  return a << 16 | (b & 0xffffU);
}
/// Likewise the high halves.
constexpr Word pack_high(Word a, Word b) {
  return (a & 0xffff0000U) | b >> 16;
}
/// The low bytes of two words in the upper (lower) half of `into`.
constexpr Word packhi(Word into, Word a, Word b) {
  return (into & 0x0000ffffU) | (a & 0xffU) << 24 | (b & 0xffU) << 16;
}
constexpr Word packlo(Word into, Word a, Word b) {
  return (into & 0xffff0000U) | (a & 0xffU) << 8 | (b & 0xffU);
}

}  // namespace mebots::soc::operations
