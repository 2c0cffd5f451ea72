// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace mebots::master {

/// Selects one of the two values that a signal has at a jump: the value before or after the jump.
enum class SignalSide : std::uint8_t { before, after };

/// A time in nanoseconds, and the double that FMUs receive for this time.
struct SignalTime {
  std::int64_t ns = 0;
  double s = 0;
};

/// The times of a file's rows. They never decrease. Two rows that have the same time represent a jump. Rows and
/// communication points are compared in whole nanoseconds. Therefore nine decimals are enough to write a time such as
/// 1/60 s in a file.
class SignalTimes {
 public:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  /// `times_s` must not be empty, and no time may exceed kLongestTimeS.
  explicit SignalTimes(std::vector<double> times_s) : times_s_(std::move(times_s)) {}

  std::size_t size() const { return times_s_.size(); }
  double s(std::size_t row) const { return times_s_[row]; }
  std::int64_t ns(std::size_t row) const;
  /// Returns the row whose value applies at this time: the last row that is not later than `time_ns`. If several rows
  /// have this time (a jump) and `side` is `before`, returns the first of these rows. Returns kNone before the first
  /// row. The search starts at row `near`, which should be the result of an earlier call. Therefore the cost does not
  /// depend on the number of rows if time advances in small steps.
  std::size_t row_at(std::int64_t time_ns, SignalSide side, std::size_t near) const;

 private:
  std::vector<double> times_s_;
};

/// The values of a variable over time, read from a column of a file. They are Reals, Integers or texts. Items of
/// enumerations are stored as Integers, Booleans as the Integers 0 and 1. Before the first row, the first value
/// applies; after the last row, the last value applies.
class Signal {
 public:
  using Values = std::variant<std::vector<double>, std::vector<std::int64_t>, std::vector<std::string>>;
  using Value = std::variant<double, std::int64_t, std::string>;

  /// `values` must contain one value for each time. If `linear` is true, Reals are interpolated between rows;
  /// otherwise, each value is constant until the next row.
  Signal(std::shared_ptr<const SignalTimes> times, Values values, bool linear)
      : times_(std::move(times)), values_(std::move(values)), linear_(linear) {}

  const SignalTimes& times() const { return *times_; }
  bool linear() const { return linear_; }
  /// True if the values in these two rows differ.
  bool differ(std::size_t row, std::size_t other) const;
  /// Returns the value at a time. `near` is a variable of the caller; it must be 0 at first, and speeds up the next
  /// search.
  Value at(const SignalTime& time, SignalSide side, std::size_t& near) const;
  /// Returns the mean slope between two times: from the value after a jump at `from` to the value before a jump at
  /// `to`. If `linear` is false, the slope is 0.
  double slope(const SignalTime& from, const SignalTime& to, std::size_t& near) const;

 private:
  double real_at(const SignalTime& time, SignalSide side, std::size_t& near) const;

  std::shared_ptr<const SignalTimes> times_;
  Values values_;
  bool linear_;
};

}  // namespace mebots::master
