// SPDX-License-Identifier: Apache-2.0
#include "base/time.hpp"

#include "mebots/assert.hpp"
#include "mebots/input_error.hpp"

#include <fmt/format.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

namespace mebots::master {
namespace {

__extension__ using WideUnsigned = unsigned __int128;

constexpr std::int64_t kExactDouble = std::int64_t{1} << 53;  // a double can represent all smaller whole numbers
constexpr std::int64_t kLongestTime_s = 9'200'000'000;
constexpr std::int64_t kLargestWrittenDenominator = kNanosecondsPerSecond;

WideInteger magnitude(WideInteger value) {
  return value < 0 ? -value : value;
}

WideInteger greatest_common_divisor(WideInteger a, WideInteger b) {
  while (b != 0) {
    const auto rest = a % b;
    a = b;
    b = rest;
  }
  return a;
}

int bit_width(WideUnsigned value) {
  const auto high = static_cast<std::uint64_t>(value >> 64);
  return high != 0 ? 64 + std::bit_width(high) : std::bit_width(static_cast<std::uint64_t>(value));
}

/// True if p / q differs from x = m / 2^shift by at most 1e-15 x.
bool means(std::int64_t p, std::int64_t q, std::int64_t m, int shift) {
  // |p 2^shift - m q| <= 1e-15 m q. Convergents of x satisfy p <= x q + 1, so that p 2^shift is below 2^102.
  const auto product = WideInteger{m} * q;
  const auto difference = magnitude((WideInteger{p} << shift) - product);
  constexpr std::int64_t kPerTolerance = 1'000'000'000'000'000;
  constexpr WideInteger kFits = WideInteger{1} << 76;
  return difference < kFits && difference * kPerTolerance <= product;
}

/// Finds a ratio near x, which must be above 0 and below 2^34. By Legendre's theorem, each ratio within the tolerance
/// is a convergent of the continued fraction of x. Returns the first convergent within the tolerance.
std::optional<ExactTime> ratio_near(double x) {
  int exponent = 0;
  const auto m = static_cast<std::int64_t>(std::ldexp(std::frexp(x, &exponent), 53));
  const int shift = 53 - exponent;
  if (shift <= 0 || shift > 100) return std::nullopt;  // a whole number, or below 2^-47 s
  WideInteger numerator = m;
  WideInteger denominator = WideInteger{1} << shift;
  std::int64_t p_before = 0, q_before = 1, p = 1, q = 0;
  while (denominator != 0) {
    const auto part = numerator / denominator;
    const auto p_next = part * p + p_before;
    const auto q_next = part * q + q_before;
    if (q_next > kLargestDenominator || p_next > std::numeric_limits<std::int64_t>::max()) return std::nullopt;
    p_before = std::exchange(p, static_cast<std::int64_t>(p_next));
    q_before = std::exchange(q, static_cast<std::int64_t>(q_next));
    if (p != 0 && means(p, q, m, shift)) return ExactTime{p, q};
    numerator = std::exchange(denominator, numerator % denominator);
  }
  return std::nullopt;
}

std::optional<std::int64_t> whole_number(std::string_view digits) {
  std::int64_t value = 0;
  const auto* end = digits.data() + digits.size();
  const auto result = std::from_chars(digits.data(), end, value);
  if (digits.empty() || result.ec != std::errc{} || result.ptr != end) return std::nullopt;
  return value;
}

}  // namespace

std::optional<std::int64_t> to_nanoseconds(double seconds) {
  if (!std::isfinite(seconds) || std::abs(seconds) > kLongestTimeS) return std::nullopt;
  const double scaled = seconds * 1e9;
  const double whole = std::round(scaled);
  // The decimal number and its product with 1e9 were both rounded. The total error is at most two units in the last
  // place.
  const double rounding = 2 * std::numeric_limits<double>::epsilon() * std::abs(scaled);
  if (std::abs(scaled - whole) > rounding + 1e-9) return std::nullopt;
  return static_cast<std::int64_t>(whole);
}

std::optional<ExactTime> exact_time(double seconds) {
  if (const auto time_ns = to_nanoseconds(seconds)) return exact_time_of(*time_ns);
  if (!std::isfinite(seconds) || std::abs(seconds) > kLongestTimeS) return std::nullopt;
  auto ratio = ratio_near(std::abs(seconds));
  if (ratio && seconds < 0) ratio->numerator = -ratio->numerator;
  return ratio;
}

std::optional<ExactTime> read_ratio(std::string_view text) {
  const auto slash = text.find('/');
  if (slash == std::string_view::npos || text.substr(slash + 1).starts_with('-')) return std::nullopt;
  const auto numerator = whole_number(text.substr(0, slash));
  const auto denominator = whole_number(text.substr(slash + 1));
  if (!numerator || !denominator || *denominator == 0) return std::nullopt;
  const auto time = reduced(*numerator, *denominator);
  if (time.denominator > kLargestWrittenDenominator) return std::nullopt;
  if (magnitude(time.numerator) > WideInteger{kLongestTime_s} * time.denominator) return std::nullopt;
  return time;
}

ExactTime exact_time_of(std::int64_t time_ns) {
  return reduced(time_ns, kNanosecondsPerSecond);
}

ExactTime reduced(WideInteger numerator, WideInteger denominator) {
  MEBOTS_ASSERT(denominator > 0);
  const auto divisor = greatest_common_divisor(magnitude(numerator), denominator);
  numerator /= divisor;
  MEBOTS_ASSERT(magnitude(numerator) <= std::numeric_limits<std::int64_t>::max(), "an ExactTime holds the ratio");
  return {static_cast<std::int64_t>(numerator), static_cast<std::int64_t>(denominator / divisor)};
}

std::int64_t nearest_whole(WideInteger numerator, WideInteger denominator) {
  MEBOTS_ASSERT(denominator > 0);
  auto whole = numerator / denominator;
  auto rest = numerator % denominator;
  if (rest < 0) {
    rest += denominator;
    --whole;
  }
  const auto above_half = rest - (denominator - rest);
  if (above_half > 0 || (above_half == 0 && whole % 2 != 0)) ++whole;
  return static_cast<std::int64_t>(whole);
}

double nearest_double(WideInteger numerator, std::int64_t denominator) {
  MEBOTS_ASSERT(denominator > 0 && denominator <= std::int64_t{1} << 60);
  const auto size = magnitude(numerator);
  // Both numbers are exact as doubles. Only their quotient is rounded.
  if (size <= kExactDouble && denominator <= kExactDouble) {
    return static_cast<double>(static_cast<std::int64_t>(numerator)) / static_cast<double>(denominator);
  }
  // The quotient of the shifted numerator has at least 66 bits, more than a double. Its lowest bit can therefore
  // represent the remainder, so that only the conversion to a double rounds.
  MEBOTS_ASSERT(bit_width(static_cast<WideUnsigned>(size)) <= 126);
  const int shift = 127 - bit_width(static_cast<WideUnsigned>(size));
  const auto shifted = static_cast<WideUnsigned>(size) << shift;
  const auto divisor = static_cast<WideUnsigned>(denominator);
  const auto quotient = shifted / divisor | static_cast<WideUnsigned>(shifted % divisor != 0);
  const double result = std::ldexp(static_cast<double>(quotient), -shift);
  return numerator < 0 ? -result : result;
}

std::int64_t to_nanoseconds(const ExactTime& time) {
  return nearest_whole(WideInteger{time.numerator} * kNanosecondsPerSecond, time.denominator);
}

double to_seconds(std::int64_t time_ns) {
  if (time_ns <= kExactDouble && time_ns >= -kExactDouble) return static_cast<double>(time_ns) / 1e9;
  return nearest_double(time_ns, kNanosecondsPerSecond);
}

double to_seconds(const ExactTime& time) {
  return nearest_double(time.numerator, time.denominator);
}

std::string time_text(const ExactTime& time) {
  if (time.is_whole_nanoseconds()) return fmt::format("{}", to_seconds(time));
  return fmt::format("{}/{}", time.numerator, time.denominator);
}

std::string time_text(const WrittenTime& written) {
  if (const auto* seconds = std::get_if<double>(&written)) return fmt::format("{}", *seconds);
  return std::get<std::string>(written);
}

std::int64_t nanoseconds_of(double seconds, std::string_view what) {
  const auto time = exact_time(seconds);
  if (!time) {
    throw InputError(ErrorCode::invalid_argument,
                     fmt::format("{}: {} s is neither a whole number of nanoseconds nor a ratio with a denominator up "
                                 "to {}",
                                 what, seconds, kLargestDenominator));
  }
  return to_nanoseconds(*time);
}

std::int64_t duration_of(double seconds, std::string_view what) {
  const auto time_ns = nanoseconds_of(seconds, what);
  if (time_ns <= 0) {
    throw InputError(ErrorCode::invalid_argument, fmt::format("{}: {} s must be greater than 0 s", what, seconds));
  }
  return time_ns;
}

}  // namespace mebots::master
