// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace mebots::master {

/// At a jump a signal has two values: one before and one after.
enum class SignalSide : std::uint8_t { before, after };

/// A time in nanoseconds, and the double that is passed to FMUs for this time.
struct SignalTime {
  std::int64_t ns = 0;
  double s = 0;
};

/// The times of a file's rows. The times never decrease. Two rows with the same time are a jump. Rows and communication
/// points are compared in whole nanoseconds. Therefore nine decimals are enough to write a time such as 1/60 s in a
/// file.
class SignalTimes {
 public:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  /// `times_s` must not be empty, and no time may be above kLongestTimeS.
  explicit SignalTimes(std::vector<double> times_s) : times_s_(std::move(times_s)) {}

  std::size_t size() const { return times_s_.size(); }
  double s(std::size_t row) const { return times_s_[row]; }
  std::int64_t ns(std::size_t row) const;
  /// Returns the row whose value applies at this time: the last row that is not later. If several rows have this time
  /// (a jump) and the side before the jump is requested, returns the first of these rows. Returns kNone before the
  /// first row. The search starts at row `near`, which is the result of an earlier call. Therefore the cost does not
  /// depend on the number of rows if time advances in small steps.
  std::size_t row_at(std::int64_t time_ns, SignalSide side, std::size_t near) const;

 private:
  std::vector<double> times_s_;
};

/// The values of a variable over time, from a column of a file. The values are Reals, Integers or texts. Enumeration
/// items are Integers, and Booleans are the Integers 0 and 1. Before the first row, the first value applies; after the
/// last row, the last value applies.
class Signal {
 public:
  using Values = std::variant<std::vector<double>, std::vector<std::int64_t>, std::vector<std::string>>;
  using Value = std::variant<double, std::int64_t, std::string>;

  /// `values` has one value per time. If `linear` is true, Reals are interpolated between rows; otherwise each value is
  /// held until the next row.
  Signal(std::shared_ptr<const SignalTimes> times, Values values, bool linear)
      : times_(std::move(times)), values_(std::move(values)), linear_(linear) {}

  const SignalTimes& times() const { return *times_; }
  bool linear() const { return linear_; }
  /// True if the values in two rows differ.
  bool differ(std::size_t row, std::size_t other) const;
  /// Returns the value at a time. `near` is a variable of the caller that starts at 0 and speeds up the next search.
  Value at(const SignalTime& time, SignalSide side, std::size_t& near) const;
  /// Returns the slope between two times: from the value after a jump at `from` to the value before a jump at `to`. The
  /// slope of a held signal is 0.
  double slope(const SignalTime& from, const SignalTime& to, std::size_t& near) const;

 private:
  double real_at(const SignalTime& time, SignalSide side, std::size_t& near) const;

  std::shared_ptr<const SignalTimes> times_;
  Values values_;
  bool linear_;
};

}  // namespace mebots::master
