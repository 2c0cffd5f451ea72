// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/run_options.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace mebots::master {

/// Simulated time is counted in whole nanoseconds. It is converted to seconds only for FMUs and in files.
inline constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

/// The longest accepted time [s]. 64 bits can count this many seconds in nanoseconds.
inline constexpr double kLongestTimeS = 9.2e9;

/// The largest denominator of a ratio that exact_time() finds for a decimal number.
inline constexpr std::int64_t kLargestDenominator = 1'000'000;

/// Holds intermediate results of exact arithmetic with times.
__extension__ using WideInteger = __int128;

/// A time [s] as a ratio of whole numbers in lowest terms. The numerator is at most 9.2e18, the denominator at most
/// 1e9.
struct ExactTime {
  std::int64_t numerator = 0;
  std::int64_t denominator = 1;  ///< greater than 0

  bool operator==(const ExactTime&) const = default;
  bool is_whole_nanoseconds() const { return kNanosecondsPerSecond % denominator == 0; }
};

/// Converts a decimal number of seconds to nanoseconds. Returns empty if the time is not a whole number of nanoseconds,
/// not finite, or longer than kLongestTimeS. Tolerates the binary rounding error of a decimal fraction (0.1, 0.002),
/// but not a fraction of a nanosecond.
std::optional<std::int64_t> to_nanoseconds(double seconds);

/// Converts a decimal number of seconds to an exact time. Prefers whole nanoseconds, as to_nanoseconds() does.
/// Otherwise returns a ratio whose denominator is at most kLargestDenominator and which differs from the number by at
/// most 1e-15 (relative). Returns empty if neither exists.
std::optional<ExactTime> exact_time(double seconds);

/// Reads a ratio of whole numbers such as "1/60" or "-1/3". Returns empty for any other text, for a denominator above
/// 1e9, and for a time longer than kLongestTimeS.
std::optional<ExactTime> read_ratio(std::string_view text);

ExactTime exact_time_of(std::int64_t time_ns);

/// Converts a time [s], which is an argument of a call, to nanoseconds. Throws InputError if the time is neither a
/// whole number of nanoseconds nor a ratio that exact_time() accepts. Rounds a ratio to nanoseconds. `what` names the
/// time in the error.
std::int64_t nanoseconds_of(double seconds, std::string_view what);
/// Converts a duration as nanoseconds_of() converts a time. Throws InputError unless the duration is greater than 0.
std::int64_t duration_of(double seconds, std::string_view what);

/// Returns the ratio in lowest terms. The result must fit into an ExactTime.
ExactTime reduced(WideInteger numerator, WideInteger denominator);

/// Rounds to whole nanoseconds, ties to even.
std::int64_t to_nanoseconds(const ExactTime& time);

/// Returns the double nearest to numerator / denominator, ties to even. The numerator's magnitude must be below 2^126,
/// the denominator between 1 and 2^60.
double nearest_double(WideInteger numerator, std::int64_t denominator);

/// Returns numerator / denominator rounded to a whole number, ties to even. The denominator must be greater than 0.
std::int64_t nearest_whole(WideInteger numerator, WideInteger denominator);

/// Returns the double nearest to the time in seconds.
double to_seconds(std::int64_t time_ns);
double to_seconds(const ExactTime& time);

/// Returns the time in seconds as a text: "0.002", or "1/60" if it is not a whole number of nanoseconds.
std::string time_text(const ExactTime& time);
std::string time_text(const WrittenTime& written);

}  // namespace mebots::master
