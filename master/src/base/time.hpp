// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/run_options.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace mebots::master {

/// Simulated time is counted in whole nanoseconds; seconds appear only at the FMI boundary and in files.
inline constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

/// The longest time that is accepted [s]: what 64 bits of nanoseconds hold, rounded down.
inline constexpr double kLongestTimeS = 9.2e9;

/// The largest denominator of a ratio that a decimal number can mean.
inline constexpr std::int64_t kLargestDenominator = 1'000'000;

/// Intermediate results of exact arithmetic with times.
__extension__ using WideInteger = __int128;

/// A time [s] as a ratio of whole numbers in lowest terms. Numerator and denominator are at most 9.2e18 and 1e9.
struct ExactTime {
  std::int64_t numerator = 0;
  std::int64_t denominator = 1;  ///< above 0

  bool operator==(const ExactTime&) const = default;
  bool is_whole_nanoseconds() const { return kNanosecondsPerSecond % denominator == 0; }
};

/// Returns the nanoseconds that a decimal number of seconds means. Returns nothing if it is not a whole number of
/// nanoseconds, not finite, or longer than kLongestTimeS. The binary rounding of a decimal fraction (0.1, 0.002) is
/// forgiven, a fraction of a nanosecond is not.
std::optional<std::int64_t> to_nanoseconds(double seconds);

/// Returns the exact time that a decimal number of seconds means: whole nanoseconds as to_nanoseconds() finds
/// them, else the ratio with a denominator up to kLargestDenominator that is within 1e-15 of the number (relative).
/// Returns nothing if there is neither.
std::optional<ExactTime> exact_time(double seconds);

/// Reads a ratio of whole numbers such as "1/60" or "-1/3". Returns nothing for any other text, for a denominator above
/// 1e9, and for a time longer than kLongestTimeS.
std::optional<ExactTime> read_ratio(std::string_view text);

ExactTime exact_time_of(std::int64_t time_ns);

/// Returns a time that a program gave, rounded to nanoseconds. Throws InputError that names it `what`, if it is neither
/// a whole number of nanoseconds nor a ratio as of exact_time().
std::int64_t nanoseconds_of(double seconds, std::string_view what);
/// The same of a time that must be greater than 0.
std::int64_t duration_of(double seconds, std::string_view what);

/// Returns the ratio in lowest terms. The result must fit into an ExactTime.
ExactTime reduced(WideInteger numerator, WideInteger denominator);

/// Rounds to whole nanoseconds, ties to even.
std::int64_t to_nanoseconds(const ExactTime& time);

/// Returns the double nearest to numerator / denominator, ties to even. The numerator's magnitude must be below 2^126,
/// the denominator between 1 and 2^60.
double nearest_double(WideInteger numerator, std::int64_t denominator);

/// Returns numerator / denominator rounded to a whole number, ties to even; the denominator is above 0.
std::int64_t nearest_whole(WideInteger numerator, WideInteger denominator);

/// Seconds as the double nearest to the exact value.
double to_seconds(std::int64_t time_ns);
double to_seconds(const ExactTime& time);

/// "0.002", or "1/60" for a time that is not a whole number of nanoseconds.
std::string time_text(const ExactTime& time);
std::string time_text(const WrittenTime& written);

}  // namespace mebots::master
