// SPDX-License-Identifier: Apache-2.0
#include "instructions/float32.hpp"

#include "mebots/assert.hpp"

#include <algorithm>
#include <bit>
#include <utility>

namespace mebots::soc::float32 {
namespace {

constexpr int kFractionBits = 23;
constexpr int kLeastExponent = -126;                          // exponent of the smallest normal number
constexpr int kLeastWeight = kLeastExponent - kFractionBits;  // exponent of the lowest bit in a subnormal number
constexpr std::uint32_t kHiddenBit = std::uint32_t{1} << kFractionBits;
constexpr std::uint32_t kLargest = kInfinity - 1;
// Highest bit of a significand from normal(), so that the sum of two significands fits in 63 bits.
constexpr int kTop = 61;

/// An exact finite value: significand * 2^exponent.
struct Exact {
  bool sign = false;
  int exponent = 0;
  std::uint64_t significand = 0;
};

constexpr bool is_negative(std::uint32_t a) {
  return (a & kSign) != 0;
}
constexpr bool is_infinite(std::uint32_t a) {
  return (a & ~kSign) == kInfinity;
}
constexpr bool is_zero(std::uint32_t a) {
  return (a & ~kSign) == 0;
}
constexpr std::uint32_t with_sign(bool sign, std::uint32_t magnitude) {
  return magnitude | (sign ? kSign : 0U);
}

Exact exact(std::uint32_t a) {
  MEBOTS_ASSERT((a & ~kSign) < kInfinity, "only finite numbers have a value");
  const auto exponent = static_cast<int>(a >> kFractionBits & 0xffU);
  const auto fraction = a & (kHiddenBit - 1U);
  if (exponent == 0) return {is_negative(a), kLeastWeight, fraction};
  return {is_negative(a), exponent - 1 + kLeastWeight, fraction | kHiddenBit};
}

/// Shifts the significand so that its highest set bit is bit kTop. The significand must not be 0.
Exact normal(Exact a) {
  const auto shift = std::countl_zero(a.significand) - (63 - kTop);
  MEBOTS_ASSERT(a.significand != 0 && shift >= 0);
  return {a.sign, a.exponent - shift, a.significand << shift};
}

/// Shifts a value to the right. Sets the lowest bit of the result if a bit that is shifted out is 1, so that later
/// rounding is still correct.
std::uint64_t shift_right_sticky(std::uint64_t value, int places) {
  if (places > 63) return value != 0 ? 1 : 0;
  const auto lost = value & ((std::uint64_t{1} << places) - 1U);
  return (value >> places) | (lost != 0 ? 1U : 0U);
}

std::uint32_t nan_of(Context& context, bool invalid) {
  if (invalid) context.flags |= kInvalid;
  return kCanonicalNan;
}

struct Shifted {
  std::uint64_t value = 0;
  bool inexact = false;
};

/// Divides by 2^places and rounds to an integer. `value` has at most 63 bits.
Shifted rounded(std::uint64_t value, int places, bool sign, Rounding rounding) {
  MEBOTS_ASSERT(places > 0 && value >> 63 == 0);
  const bool all = places > 63;  // all bits are shifted out: the result is below a half
  const auto kept = all ? 0 : value >> places;
  const auto rest = all ? value : value & ((std::uint64_t{1} << places) - 1U);
  const auto half = all ? std::uint64_t{1} << 63 : std::uint64_t{1} << (places - 1);
  bool up = false;
  switch (rounding) {
    case Rounding::nearest_even:
      up = rest > half || (rest == half && (kept & 1U) != 0);
      break;
    case Rounding::nearest_away:
      up = rest >= half;
      break;
    case Rounding::to_zero:
      break;
    case Rounding::down:
      up = sign && rest != 0;
      break;
    case Rounding::up:
      up = !sign && rest != 0;
      break;
  }
  return {kept + (up ? 1U : 0U), rest != 0};
}

std::uint32_t overflowed(bool sign, Context& context) {
  context.flags |= kOverflow | kInexact;
  const bool to_largest = context.rounding == Rounding::to_zero || (context.rounding == Rounding::down && !sign) ||
                          (context.rounding == Rounding::up && sign);
  return with_sign(sign, to_largest ? kLargest : kInfinity);
}

/// Rounds an exact value to a float. The lowest bit of the significand may be sticky: it is also set if a lower bit was
/// not 0.
std::uint32_t pack(Exact value, Context& context) {
  if (value.significand == 0) return with_sign(value.sign, 0);
  value = normal(value);
  const int exponent = value.exponent + kTop;  // 2^exponent <= magnitude < 2^(exponent + 1)
  const int weight = std::max(exponent - kFractionBits, kLeastWeight);
  const auto [kept, inexact] = rounded(value.significand, weight - value.exponent, value.sign, context.rounding);
  if (inexact) {
    context.flags |= kInexact;
    // Detects tininess after rounding: the result is tiny if the value, rounded to 24 bits, is below the least normal
    // number.
    const bool below = exponent < kLeastExponent;
    const bool reaches = exponent == kLeastExponent - 1 &&
                         rounded(value.significand, kTop - kFractionBits, value.sign, context.rounding).value ==
                             std::uint64_t{kHiddenBit} << 1;
    if (below && !reaches) context.flags |= kUnderflow;
  }
  const auto biased = static_cast<std::uint64_t>(weight - kLeastWeight) + (kept >> kFractionBits);
  if (biased >= kInfinity >> kFractionBits) return overflowed(value.sign, context);
  return with_sign(value.sign, (static_cast<std::uint32_t>(weight - kLeastWeight) << kFractionBits) +
                                   static_cast<std::uint32_t>(kept));
}

std::uint32_t packed_sum(Exact a, Exact b, Context& context) {
  const auto zero_sign = a.sign == b.sign ? a.sign : context.rounding == Rounding::down;
  if (a.significand == 0 && b.significand == 0) return with_sign(zero_sign, 0);
  if (a.significand == 0) return pack(b, context);
  if (b.significand == 0) return pack(a, context);
  a = normal(a);
  b = normal(b);
  if (a.exponent < b.exponent || (a.exponent == b.exponent && a.significand < b.significand)) std::swap(a, b);
  // The low bits of both significands are 0. If more than one bit of `b` is shifted out, `b` is much smaller than `a`.
  // The sum then has enough exact bits above the sticky bit.
  const auto aligned = shift_right_sticky(b.significand, a.exponent - b.exponent);
  const auto sum = a.sign == b.sign ? a.significand + aligned : a.significand - aligned;
  if (sum == 0) return with_sign(zero_sign, 0);
  // The shift leaves space for normal() if the sum has one more bit.
  return pack({a.sign, a.exponent + 1, shift_right_sticky(sum, 1)}, context);
}

Exact product(std::uint32_t a, std::uint32_t b) {
  const auto x = exact(a);
  const auto y = exact(b);
  return {x.sign != y.sign, x.exponent + y.exponent, x.significand * y.significand};
}

std::uint32_t to_integer(std::uint32_t a, Context& context, std::int64_t least, std::int64_t most) {
  const auto out_of_range = [&context](std::int64_t nearest) {
    context.flags |= kInvalid;
    return static_cast<std::uint32_t>(nearest);
  };
  if (is_nan(a)) return out_of_range(most);
  if (is_infinite(a)) return out_of_range(is_negative(a) ? least : most);
  const auto value = exact(a);
  const bool beyond = value.exponent > 8;  // the magnitude is at least 2^32
  if (beyond && value.significand != 0) return out_of_range(value.sign ? least : most);
  const auto whole = value.exponent >= 0 ? Shifted{value.significand << value.exponent, false}
                                         : rounded(value.significand, -value.exponent, value.sign, context.rounding);
  const auto integer = static_cast<std::int64_t>(whole.value) * (value.sign ? -1 : 1);
  if (integer < least) return out_of_range(least);
  if (integer > most) return out_of_range(most);
  if (whole.inexact) context.flags |= kInexact;
  return static_cast<std::uint32_t>(integer);
}

/// Maps numbers other than NaN to integers in the same order. -0 is before +0.
constexpr std::int64_t order(std::uint32_t a) {
  return is_negative(a) ? -std::int64_t{a & ~kSign} - 1 : std::int64_t{a};
}

/// Applies the rules of fmin.s and fmax.s for NaN. `chosen` is the result for two numbers.
std::uint32_t number_of(std::uint32_t a, std::uint32_t b, std::uint32_t chosen, Context& context) {
  if (is_signaling(a) || is_signaling(b)) context.flags |= kInvalid;
  if (is_nan(a) && is_nan(b)) return kCanonicalNan;
  return is_nan(a) ? b : is_nan(b) ? a : chosen;
}

}  // namespace

std::uint32_t add(std::uint32_t a, std::uint32_t b, Context& context) {
  if (is_nan(a) || is_nan(b)) return nan_of(context, is_signaling(a) || is_signaling(b));
  if (is_infinite(a)) return is_infinite(b) && a != b ? nan_of(context, true) : a;
  if (is_infinite(b)) return b;
  return packed_sum(exact(a), exact(b), context);
}

std::uint32_t multiply(std::uint32_t a, std::uint32_t b, Context& context) {
  if (is_nan(a) || is_nan(b)) return nan_of(context, is_signaling(a) || is_signaling(b));
  if (is_infinite(a) || is_infinite(b)) {
    if (is_zero(a) || is_zero(b)) return nan_of(context, true);
    return with_sign(is_negative(a) != is_negative(b), kInfinity);
  }
  return pack(product(a, b), context);
}

std::uint32_t multiply_add(std::uint32_t a, std::uint32_t b, std::uint32_t c, Context& context) {
  const bool undefined = (is_infinite(a) && is_zero(b)) || (is_zero(a) && is_infinite(b));
  if (undefined) return nan_of(context, true);
  if (is_nan(a) || is_nan(b) || is_nan(c)) {
    return nan_of(context, is_signaling(a) || is_signaling(b) || is_signaling(c));
  }
  if (is_infinite(a) || is_infinite(b)) {
    const auto infinity = with_sign(is_negative(a) != is_negative(b), kInfinity);
    return is_infinite(c) && c != infinity ? nan_of(context, true) : infinity;
  }
  if (is_infinite(c)) return c;
  return packed_sum(product(a, b), exact(c), context);
}

std::uint32_t divide(std::uint32_t a, std::uint32_t b, Context& context) {
  if (is_nan(a) || is_nan(b)) return nan_of(context, is_signaling(a) || is_signaling(b));
  const bool sign = is_negative(a) != is_negative(b);
  if (is_infinite(a)) return is_infinite(b) ? nan_of(context, true) : with_sign(sign, kInfinity);
  if (is_infinite(b)) return with_sign(sign, 0);
  if (is_zero(b)) {
    if (is_zero(a)) return nan_of(context, true);
    context.flags |= kDivideByZero;
    return with_sign(sign, kInfinity);
  }
  if (is_zero(a)) return with_sign(sign, 0);
  const auto x = normal(exact(a));
  const auto y = normal(exact(b));
  const auto divisor = y.significand >> (kTop - kFractionBits);  // 24 bits; no set bit is lost
  const auto quotient = x.significand / divisor;                 // at least 38 bits
  const bool rest = x.significand % divisor != 0;
  return pack({sign, x.exponent - (y.exponent + kTop - kFractionBits) - 1, quotient << 1 | (rest ? 1U : 0U)}, context);
}

std::uint32_t square_root(std::uint32_t a, Context& context) {
  if (is_nan(a)) return nan_of(context, is_signaling(a));
  if (is_zero(a)) return a;
  if (is_negative(a)) return nan_of(context, true);
  if (is_infinite(a)) return a;
  auto x = normal(exact(a));
  if (x.exponent % 2 != 0) {
    ++x.exponent;
    x.significand >>= 1;  // the lowest bit is 0
  }
  std::uint64_t root = 0;  // 31 bits
  for (auto bit = std::uint64_t{1} << 30; bit != 0; bit >>= 1) {
    if ((root | bit) * (root | bit) <= x.significand) root |= bit;
  }
  const bool rest = root * root != x.significand;
  return pack({false, x.exponent / 2 - 1, root << 1 | (rest ? 1U : 0U)}, context);
}

std::uint32_t minimum(std::uint32_t a, std::uint32_t b, Context& context) {
  return number_of(a, b, order(a) < order(b) ? a : b, context);
}

std::uint32_t maximum(std::uint32_t a, std::uint32_t b, Context& context) {
  return number_of(a, b, order(a) < order(b) ? b : a, context);
}

bool equal(std::uint32_t a, std::uint32_t b, Context& context) {
  if (is_signaling(a) || is_signaling(b)) context.flags |= kInvalid;
  if (is_nan(a) || is_nan(b)) return false;
  return a == b || (is_zero(a) && is_zero(b));
}

bool less(std::uint32_t a, std::uint32_t b, Context& context) {
  if (is_nan(a) || is_nan(b)) {
    context.flags |= kInvalid;
    return false;
  }
  return order(a) < order(b) && !(is_zero(a) && is_zero(b));
}

bool less_or_equal(std::uint32_t a, std::uint32_t b, Context& context) {
  if (is_nan(a) || is_nan(b)) {
    context.flags |= kInvalid;
    return false;
  }
  return order(a) <= order(b) || (is_zero(a) && is_zero(b));
}

std::uint32_t to_signed(std::uint32_t a, Context& context) {
  return to_integer(a, context, -0x80000000LL, 0x7fffffffLL);
}

std::uint32_t to_unsigned(std::uint32_t a, Context& context) {
  return to_integer(a, context, 0, 0xffffffffLL);
}

std::uint32_t from_signed(std::uint32_t value, Context& context) {
  const bool sign = is_negative(value);
  return pack({sign, 0, sign ? 0U - value : value}, context);
}

std::uint32_t from_unsigned(std::uint32_t value, Context& context) {
  return pack({false, 0, value}, context);
}

std::uint32_t class_of(std::uint32_t a) {
  if (is_nan(a)) return is_signaling(a) ? 1U << 8 : 1U << 9;
  const bool negative = is_negative(a);
  if (is_infinite(a)) return negative ? 1U << 0 : 1U << 7;
  if (is_zero(a)) return negative ? 1U << 3 : 1U << 4;
  if ((a & kInfinity) == 0) return negative ? 1U << 2 : 1U << 5;
  return negative ? 1U << 1 : 1U << 6;
}

}  // namespace mebots::soc::float32
