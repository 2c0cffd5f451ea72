// SPDX-License-Identifier: Apache-2.0
#include "model/signal.hpp"

#include "mebots/assert.hpp"

#include <algorithm>
#include <cmath>

namespace mebots::master {

std::int64_t SignalTimes::ns(std::size_t row) const {
  return static_cast<std::int64_t>(std::llround(times_s_[row] * 1e9));
}

std::size_t SignalTimes::row_at(std::int64_t time_ns, SignalSide side, std::size_t near) const {
  constexpr std::size_t kNearby = 8;  // number of rows that are checked before a binary search
  MEBOTS_ASSERT(!times_s_.empty());
  if (time_ns < ns(0)) return kNone;
  // Finds the first row after `time_ns`, starting at `near`.
  auto next = near < size() && ns(near) <= time_ns ? near + 1 : 0;
  for (std::size_t i = 0; i < kNearby && next != 0 && next < size() && ns(next) <= time_ns; ++i) ++next;
  if (next == 0 || (next < size() && ns(next) <= time_ns)) {
    const auto found = std::partition_point(
        times_s_.begin() + static_cast<std::ptrdiff_t>(next), times_s_.end(),
        [&](const double& s) { return ns(static_cast<std::size_t>(&s - times_s_.data())) <= time_ns; });
    next = static_cast<std::size_t>(found - times_s_.begin());
  }
  const auto last = next - 1;
  const bool jump = side == SignalSide::before && last > 0 && ns(last) == time_ns && ns(last - 1) == time_ns;
  return jump ? last - 1 : last;
}

bool Signal::differ(std::size_t row, std::size_t other) const {
  return std::visit([&](const auto& values) { return values[row] != values[other]; }, values_);
}

double Signal::real_at(const SignalTime& time, SignalSide side, std::size_t& near) const {
  const auto& values = std::get<std::vector<double>>(values_);
  const auto row = times_->row_at(time.ns, side, near);
  if (row == SignalTimes::kNone) return values.front();
  near = row;
  if (!linear_ || row + 1 == values.size() || times_->ns(row) == time.ns) return values[row];
  const double from = values[row];
  const double to = values[row + 1];
  if (from == to) return from;  // the weights may not add up to 1
  const double from_s = times_->s(row);
  const double to_s = times_->s(row + 1);
  const double weight = (to_s - time.s) / (to_s - from_s);
  return weight * from + (1 - weight) * to;
}

Signal::Value Signal::at(const SignalTime& time, SignalSide side, std::size_t& near) const {
  if (std::holds_alternative<std::vector<double>>(values_)) return real_at(time, side, near);
  auto row = times_->row_at(time.ns, side, near);
  if (row == SignalTimes::kNone) {
    row = 0;
  } else {
    near = row;
  }
  if (const auto* numbers = std::get_if<std::vector<std::int64_t>>(&values_)) return (*numbers)[row];
  return std::get<std::vector<std::string>>(values_)[row];
}

double Signal::slope(const SignalTime& from, const SignalTime& to, std::size_t& near) const {
  if (!linear_ || to.s <= from.s) return 0;
  const double before = real_at(from, SignalSide::after, near);
  auto ahead = near;
  return (real_at(to, SignalSide::before, ahead) - before) / (to.s - from.s);
}

}  // namespace mebots::master
