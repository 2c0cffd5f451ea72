// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace mebots::master {

/// At a jump a signal has two values: the one up to that time, and the one from that time on.
enum class SignalSide : std::uint8_t { before, after };

/// A time as a run counts it, and the double that FMUs get for it.
struct SignalTime {
  std::int64_t ns = 0;
  double s = 0;
};

/// The times of a file's rows. They never decrease; two rows of one time are a jump. Rows and communication points are
/// compared in whole nanoseconds, so that a time such as 1/60 s needs no more than nine decimals.
class SignalTimes {
 public:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  /// At least one, and none above kLongestTimeS.
  explicit SignalTimes(std::vector<double> times_s) : times_s_(std::move(times_s)) {}

  std::size_t size() const { return times_s_.size(); }
  double s(std::size_t row) const { return times_s_[row]; }
  std::int64_t ns(std::size_t row) const;
  /// Returns the row whose value applies at this time: the last one that is not later or, on the side before a jump,
  /// the first one of that time; kNone before the first row. `near` is the row of an earlier answer. If time advances
  /// by small steps, a call costs the same for any number of rows.
  std::size_t row_at(std::int64_t time_ns, SignalSide side, std::size_t near) const;

 private:
  std::vector<double> times_s_;
};

/// The course of one variable over time, from a column of a file: Reals, Integers (also items of enumerations, and
/// Booleans as 0 and 1) or texts. Before the first row it has the first value, after the last row the last one.
class Signal {
 public:
  using Values = std::variant<std::vector<double>, std::vector<std::int64_t>, std::vector<std::string>>;
  using Value = std::variant<double, std::int64_t, std::string>;

  /// `values` has one value for each time. If `linear`, Reals are interpolated between rows; else each value is held
  /// until the next row.
  Signal(std::shared_ptr<const SignalTimes> times, Values values, bool linear)
      : times_(std::move(times)), values_(std::move(values)), linear_(linear) {}

  const SignalTimes& times() const { return *times_; }
  bool linear() const { return linear_; }
  /// True if two rows have different values.
  bool differ(std::size_t row, std::size_t other) const;
  /// The value at a time. `near` is the caller's: 0 at first.
  Value at(const SignalTime& time, SignalSide side, std::size_t& near) const;
  /// The slope of the line from the value after `from` to the value before `to`; 0 for a signal that is held.
  double slope(const SignalTime& from, const SignalTime& to, std::size_t& near) const;

 private:
  double real_at(const SignalTime& time, SignalSide side, std::size_t& near) const;

  std::shared_ptr<const SignalTimes> times_;
  Values values_;
  bool linear_;
};

}  // namespace mebots::master
