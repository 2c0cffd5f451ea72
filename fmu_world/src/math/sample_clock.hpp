// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/periods.hpp"
#include "mebots/state/visitor.hpp"

#include <cmath>
#include <cstdint>

namespace mebots::world {

/// Triggers a sample at the first time in each period.
class SampleClock {
 public:
  explicit SampleClock(double period_s) : period_ns_(std::llround(period_s * 1e9)) {}

  /// Returns true if a sample is due at a time. number() then returns the number of this sample.
  bool advance(std::int64_t time_ns) {
    const std::int64_t due = period_at(time_ns, period_ns_);
    if (due == number_) return false;
    number_ = due;
    return true;
  }

  /// Returns the number of the last sample, as an index for noise. Sample 0 is at time 0.
  std::uint64_t number() const { return static_cast<std::uint64_t>(number_); }

  void visit(state::Visitor& v) { v("number", number_); }

 private:
  std::int64_t period_ns_;
  std::int64_t number_ = kNoPeriod;
};

}  // namespace mebots::world
