// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace mebots::master {

/// Selects the value before or after a jump of a signal.
enum class SignalSide : std::uint8_t { before, after };

/// A time in nanoseconds, and the same time in seconds as FMUs receive it.
struct SignalTime {
  std::int64_t ns = 0;
  double s = 0;
};

/// The times of a file's rows, which never decrease. Two rows with the same time represent a jump. Times are compared
/// in whole nanoseconds, so that nine decimals are enough for a time such as 1/60 s.
class SignalTimes {
 public:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  /// `times_s` must not be empty. Its times must not exceed kLongestTimeS.
  explicit SignalTimes(std::vector<double> times_s) : times_s_(std::move(times_s)) {}

  std::size_t size() const { return times_s_.size(); }
  double s(std::size_t row) const { return times_s_[row]; }
  std::int64_t ns(std::size_t row) const;
  /// Returns the last row that is not later than `time_ns`; kNone before the first row. If several rows have the time
  /// `time_ns` and `side` is `before`, returns the first of these rows. The search starts at the row `near`. It is fast
  /// if `near` is the result of an earlier call for a similar time.
  std::size_t row_at(std::int64_t time_ns, SignalSide side, std::size_t near) const;

 private:
  std::vector<double> times_s_;
};

/// The values of a variable over time, from a column of a file. Enumerations and Booleans (0 and 1) are stored as
/// Integers. The first value applies before the first row, and the last value applies after the last row.
class Signal {
 public:
  using Values = std::variant<std::vector<double>, std::vector<std::int64_t>, std::vector<std::string>>;
  using Value = std::variant<double, std::int64_t, std::string>;

  /// `values` contains one value for each time. If `linear` is true, Reals are interpolated between the rows.
  /// Otherwise, each value applies until the next row.
  Signal(std::shared_ptr<const SignalTimes> times, Values values, bool linear)
      : times_(std::move(times)), values_(std::move(values)), linear_(linear) {}

  const SignalTimes& times() const { return *times_; }
  bool linear() const { return linear_; }
  bool differ(std::size_t row, std::size_t other) const;
  /// Returns the value at a time. `near` must be 0 in the first call and must be reused in later calls. It stores the
  /// row from which the next search starts.
  Value at(const SignalTime& time, SignalSide side, std::size_t& near) const;
  /// Returns the mean slope of the signal between two times. If the signal jumps at `from`, uses the value after the
  /// jump; if it jumps at `to`, the value before the jump. If `linear` is false, returns 0.
  double slope(const SignalTime& from, const SignalTime& to, std::size_t& near) const;

 private:
  double real_at(const SignalTime& time, SignalSide side, std::size_t& near) const;

  std::shared_ptr<const SignalTimes> times_;
  Values values_;
  bool linear_;
};

}  // namespace mebots::master
