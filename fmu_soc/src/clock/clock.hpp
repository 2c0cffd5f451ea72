// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/assert.hpp"
#include "mebots/error.hpp"
#include "mebots/soc/time.hpp"
#include "mebots/state/visitor.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>

namespace mebots::soc {

/// Converts active cycles to time. Multiplies the ticks since the last change of frequency by the period as a fraction,
/// so that rounding errors do not accumulate. Only a change of frequency rounds the time, down to a picosecond.
class Clock {
 public:
  void reset(std::uint32_t hz) {
    MEBOTS_ASSERT(hz > 0);
    set(hz);
    epoch_ps_ = 0;
    skipped_ = 0;
  }

  std::uint32_t hz() const { return static_cast<std::uint32_t>(hz_); }

  /// Changes the frequency, starting with this cycle.
  void change(std::uint32_t hz, std::uint64_t cycle) {
    MEBOTS_ASSERT(hz > 0);
    epoch_ps_ = time_of(cycle);
    skipped_ = std::uint64_t{0} - cycle;
    set(hz);
  }

  /// Returns the first cycle with this frequency. The core must not have slept since that cycle.
  std::uint64_t begin() const { return std::uint64_t{0} - skipped_; }
  /// Returns the start time of a cycle. The cycle must not be before the last change of frequency.
  Picoseconds time_of(std::uint64_t cycle) const {
    return epoch_ps_ + static_cast<Picoseconds>(scaled(cycle + skipped_, period_, 0, ticks_));
  }
  /// Returns the first cycle that starts at or after `time`.
  std::uint64_t first_at(Picoseconds time) const {
    if (time <= epoch_ps_) return std::uint64_t{0} - skipped_;
    return scaled(static_cast<std::uint64_t>(time - epoch_ps_), ticks_, period_ - 1, period_) - skipped_;
  }
  std::uint64_t first_after(Picoseconds time) const {
    if (time < epoch_ps_) return std::uint64_t{0} - skipped_;
    return scaled(static_cast<std::uint64_t>(time - epoch_ps_), ticks_, 0, period_) + 1 - skipped_;
  }
  /// Continues after a sleep: active cycle `cycle` starts at the first tick at or after `time`.
  void wake(std::uint64_t cycle, Picoseconds time) {
    const auto planned = first_at(time);
    if (planned > cycle) skipped_ += planned - cycle;
  }

  void visit(state::Visitor& v) {
    v("hz", hz_);
    v("epoch_ps", epoch_ps_);
    v("skipped", skipped_);
    if (!v.restores()) return;
    if (hz_ == 0 || hz_ > std::numeric_limits<std::uint32_t>::max()) {
      throw Error(ErrorCode::state_damaged, "a saved state is damaged: a clock without a frequency");
    }
    set(hz_);
  }

 private:
  static constexpr std::uint64_t kPsPerSecond = 1'000'000'000'000ULL;

  void set(std::uint64_t hz) {
    hz_ = hz;
    const auto common = std::gcd(kPsPerSecond, hz_);
    period_ = kPsPerSecond / common;
    ticks_ = hz_ / common;
  }
  /// Returns (value * factor + rest) / divisor. The product fits into 64 bits for hours of simulated time with a clock
  /// of whole MHz, and for minutes with GAP8's clock loops.
  static std::uint64_t scaled(std::uint64_t value, std::uint64_t factor, std::uint64_t rest, std::uint64_t divisor) {
    __extension__ using Wide = unsigned __int128;
    std::uint64_t product = 0;
    if (!__builtin_mul_overflow(value, factor, &product) && !__builtin_add_overflow(product, rest, &product)) {
      return divisor == 1 ? product : product / divisor;  // a division takes longer than the comparison
    }
    return static_cast<std::uint64_t>((Wide{value} * factor + rest) / divisor);
  }

  std::uint64_t hz_ = 1;
  // `ticks_` ticks take `period_` picoseconds. The fraction is in lowest terms, so that the frequency determines both
  // numbers.
  std::uint64_t ticks_ = 1;
  std::uint64_t period_ = kPsPerSecond;
  Picoseconds epoch_ps_ = 0;
  std::uint64_t skipped_ = 0;  // ticks slept since the epoch minus the active cycles before it (modulo 2^64)
};

/// Measures how long a state lasted in total. The argument of up_to() may be before the last begin or end, because the
/// parts of a chip have different times.
class Stopwatch {
 public:
  bool runs() const { return runs_; }
  void begin(Picoseconds time) {
    runs_ = true;
    changed_at_ = time;
  }
  void end(Picoseconds time) {
    total_ = up_to(time);
    runs_ = false;
    changed_at_ = time;
  }
  Picoseconds changed_at() const { return changed_at_; }
  Picoseconds up_to(Picoseconds now) const {
    return runs_ ? total_ + std::max<Picoseconds>(now - changed_at_, 0) : total_;
  }

  void visit(state::Visitor& v) {
    v("runs", runs_);
    v("changed_at", changed_at_);
    v("total", total_);
  }

 private:
  bool runs_ = false;
  Picoseconds changed_at_ = 0;
  Picoseconds total_ = 0;  // duration up to the last begin or end
};

}  // namespace mebots::soc
