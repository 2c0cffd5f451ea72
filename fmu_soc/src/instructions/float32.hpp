// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

/// Single-precision arithmetic of IEEE 754-2019 on bit patterns. Uses integers, so that results have the same bits on
/// every host and with every compiler. NaN results are the canonical NaN, and tininess is detected after rounding, as
/// RISC-V requires (volume I, 20240411, chapter 20).
namespace mebots::soc::float32 {

/// Rounding modes, with their values in frm and in instructions.
enum class Rounding : std::uint8_t {
  nearest_even,
  to_zero,
  down,
  up,
  nearest_away,  // ties are rounded away from zero (RMM)
};
inline constexpr unsigned kRoundings = 5;
inline constexpr unsigned kDynamic = 7;  // rounding mode of an instruction that uses the mode in frm

// Bits of fflags.
inline constexpr std::uint8_t kInexact = 1;
inline constexpr std::uint8_t kUnderflow = 2;
inline constexpr std::uint8_t kOverflow = 4;
inline constexpr std::uint8_t kDivideByZero = 8;
inline constexpr std::uint8_t kInvalid = 16;

inline constexpr std::uint32_t kSign = 0x80000000;
inline constexpr std::uint32_t kInfinity = 0x7f800000;
inline constexpr std::uint32_t kCanonicalNan = 0x7fc00000;
inline constexpr std::uint32_t kQuiet = 0x00400000;

constexpr bool is_nan(std::uint32_t a) {
  return (a & ~kSign) > kInfinity;
}
constexpr bool is_signaling(std::uint32_t a) {
  return is_nan(a) && (a & kQuiet) == 0;
}

/// Contains the rounding mode of an operation, and receives the flags that the operation raises.
struct Context {
  Rounding rounding = Rounding::nearest_even;
  std::uint8_t flags = 0;
};

std::uint32_t add(std::uint32_t a, std::uint32_t b, Context& context);
std::uint32_t multiply(std::uint32_t a, std::uint32_t b, Context& context);
/// Returns a * b + c, rounded once.
std::uint32_t multiply_add(std::uint32_t a, std::uint32_t b, std::uint32_t c, Context& context);
std::uint32_t divide(std::uint32_t a, std::uint32_t b, Context& context);
std::uint32_t square_root(std::uint32_t a, Context& context);
std::uint32_t minimum(std::uint32_t a, std::uint32_t b, Context& context);
std::uint32_t maximum(std::uint32_t a, std::uint32_t b, Context& context);
bool equal(std::uint32_t a, std::uint32_t b, Context& context);
bool less(std::uint32_t a, std::uint32_t b, Context& context);
bool less_or_equal(std::uint32_t a, std::uint32_t b, Context& context);
/// Convert from and to integers. A value out of range becomes the nearest limit of the range, and NaN the upper limit.
std::uint32_t to_signed(std::uint32_t a, Context& context);
std::uint32_t to_unsigned(std::uint32_t a, Context& context);
std::uint32_t from_signed(std::uint32_t value, Context& context);
std::uint32_t from_unsigned(std::uint32_t value, Context& context);
/// Returns the class of a number as a mask, as fclass.s does.
std::uint32_t class_of(std::uint32_t a);

}  // namespace mebots::soc::float32
