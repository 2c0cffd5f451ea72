// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/run_options.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace mebots::master {

/// Simulated time is a whole number of nanoseconds. Only FMUs and files use seconds.
inline constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

/// The longest accepted time in seconds. In nanoseconds, it fits into 64 bits.
inline constexpr double kLongestTimeS = 9.2e9;

/// The largest denominator of a time that exact_time(double) returns, unless the time is a whole number of nanoseconds.
inline constexpr std::int64_t kLargestDenominator = 1'000'000;

/// The type of intermediate results in exact arithmetic.
__extension__ using WideInteger = __int128;

/// A time in seconds as a ratio of whole numbers in lowest terms. The numerator is at most 9.2e18, and the denominator
/// is at most 1e9.
struct ExactTime {
  std::int64_t numerator = 0;
  std::int64_t denominator = 1;  ///< positive

  bool operator==(const ExactTime&) const = default;
  bool is_whole_nanoseconds() const { return kNanosecondsPerSecond % denominator == 0; }
};

/// Converts seconds to nanoseconds. Tolerates the rounding error of a decimal fraction such as 0.1 in binary. Returns
/// nullopt if the time is not a whole number of nanoseconds, not finite, or longer than kLongestTimeS.
std::optional<std::int64_t> to_nanoseconds(double seconds);

/// Converts seconds to an exact time: whole nanoseconds if to_nanoseconds() accepts the time, otherwise a ratio. The
/// denominator of the ratio is at most kLargestDenominator. Its relative difference from `seconds` is at most 1e-15.
/// Returns nullopt if there is no such time.
std::optional<ExactTime> exact_time(double seconds);

/// Parses a ratio of whole numbers, such as "1/60" or "-1/3". Returns nullopt for other texts, for a denominator above
/// 1e9, and for a time longer than kLongestTimeS.
std::optional<ExactTime> read_ratio(std::string_view text);

ExactTime exact_time_of(std::int64_t time_ns);

/// Converts seconds to whole nanoseconds. Rounds a time such as 1/60 s, ties to even. If exact_time() does not accept
/// the time, throws InputError. The error contains `what`, the name of the time.
std::int64_t nanoseconds_of(double seconds, std::string_view what);
/// Converts a duration like nanoseconds_of(). Throws InputError if the duration is not positive.
std::int64_t duration_of(double seconds, std::string_view what);

/// Reduces a ratio to lowest terms. The result must fit into an ExactTime.
ExactTime reduced(WideInteger numerator, WideInteger denominator);

/// Rounds to whole nanoseconds, ties to even.
std::int64_t to_nanoseconds(const ExactTime& time);

/// Returns the double nearest to numerator / denominator, ties to even. The magnitude of the numerator must be below
/// 2^126. The denominator must be from 1 to 2^60.
double nearest_double(WideInteger numerator, std::int64_t denominator);

/// Returns numerator / denominator rounded to a whole number, ties to even. The denominator must be positive.
std::int64_t nearest_whole(WideInteger numerator, WideInteger denominator);

/// Returns the double nearest to the time in seconds.
double to_seconds(std::int64_t time_ns);
double to_seconds(const ExactTime& time);

/// Formats a time in seconds, such as "0.002". A time that is not a whole number of nanoseconds is a ratio, such as
/// "1/60".
std::string time_text(const ExactTime& time);
std::string time_text(const WrittenTime& written);

}  // namespace mebots::master
