// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "devices/gap8/signals.hpp"
#include "mebots/soc/device.hpp"
#include "mebots/state/visitor.hpp"

#include <array>
#include <cstdint>
#include <functional>
#include <utility>

namespace mebots::soc::gap8_devices {

/// Defines the clock of a timer's counters. Times have the unit of the timer's owner: picoseconds, or ticks of a clock.
class TimerClock {
 public:
  TimerClock() = default;
  TimerClock(const TimerClock&) = delete;
  TimerClock& operator=(const TimerClock&) = delete;
  virtual ~TimerClock() = default;

  /// Returns the largest time. An event at this time never occurs.
  virtual std::int64_t never() const = 0;
  /// Returns by how much a counter with this configuration increases between two times.
  virtual std::uint64_t counts(std::uint32_t config, std::int64_t from, std::int64_t to) const = 0;
  /// Returns the time at which a counter has increased by `counts` since `since`, or never() if this time is out of
  /// range.
  virtual std::int64_t time_of(std::uint32_t config, std::int64_t since, std::uint64_t counts) const = 0;
};

/// Models the counters of GAP8's timers: two 32-bit counters. When a counter reaches its compare value, it can raise an
/// event, restart and stop. The two counters can form one 64-bit counter. Source: archi/timer/timer_v2.h.
class TimerCounters {
 public:
  static constexpr std::uint32_t kReferenceClock = 1U << 7;
  static constexpr std::uint32_t kSpan = 0x28;

  /// `raise` is called when the low (0) or the high (1) counter matches its compare value. `clock` must outlive this
  /// object.
  TimerCounters(const TimerClock& clock, std::function<void(unsigned counter)> raise)
      : clock_(clock), raise_(std::move(raise)) {}

  /// If no register has this offset, load() and store() return false.
  bool load(std::uint32_t offset, std::int64_t now, std::uint32_t& value);
  bool store(std::uint32_t offset, std::int64_t now, std::uint32_t value);
  /// Updates the counts to `now`. Must be called before the clock changes.
  void count(std::int64_t now);
  void advance(std::int64_t now);
  std::int64_t next_event() const;
  void reset() { counters_ = {}; }
  void visit(state::Visitor& v) { v("counters", counters_); }

  static std::uint32_t divider_of(std::uint32_t config);

 private:
  struct Counter {
    std::uint32_t config = 0;
    std::uint32_t compare = 0;
    std::uint64_t value = 0;        // count at `since`; for a 64-bit counter, the low counter stores all bits
    std::uint64_t compared_at = 0;  // count at the last match
    bool met = false;               // true from a match until the count or the compare value changes
    std::int64_t since = 0;

    void visit(state::Visitor& v) {
      v("config", config);
      v("compare", compare);
      v("value", value);
      v("compared_at", compared_at);
      v("met", met);
      v("since", since);
    }
  };

  bool is_pair() const;
  std::uint64_t width_mask() const { return is_pair() ? ~std::uint64_t{0} : 0xffffffffU; }
  std::uint64_t target_of(unsigned index) const;
  void count_one(Counter& counter, std::int64_t now);
  void compare(unsigned index);
  void configure(unsigned index, std::uint32_t config);
  void pair_or_split();

  const TimerClock& clock_;
  std::function<void(unsigned counter)> raise_;
  std::array<Counter, 2> counters_;
};

/// Models GAP8's timer of the fabric controller. Its counters count the controller's clock or the reference clock.
class Timer final : public Device, private TimerClock {
 public:
  /// `clock_hz` returns the present clock frequency of the fabric controller.
  Timer(Signals& signals, std::function<double()> clock_hz);

  bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) override {
    return counters_.load(offset, now, value);
  }
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override {
    return counters_.store(offset, now, value);
  }
  void advance(Picoseconds now) override { counters_.advance(now); }
  Picoseconds next_event() const override { return counters_.next_event(); }
  void visit(state::Visitor& v) override { counters_.visit(v); }

 private:
  std::int64_t never() const override { return kNever; }
  std::uint64_t counts(std::uint32_t config, Picoseconds from, Picoseconds to) const override;
  Picoseconds time_of(std::uint32_t config, Picoseconds since, std::uint64_t counts) const override;

  std::function<double()> clock_hz_;
  TimerCounters counters_;
};

/// Models the timer that the cores of GAP8's cluster share. It counts ticks of the cluster's clock. Counting the
/// reference clock, which silicon can do, is not modelled: such a counter does not count.
class ClusterTimer : private TimerClock {
 public:
  explicit ClusterTimer(std::function<void(unsigned counter)> raise) : counters_(*this, std::move(raise)) {}

  bool load(std::uint32_t offset, std::uint64_t tick, std::uint32_t& value) {
    return counters_.load(offset, static_cast<std::int64_t>(tick), value);
  }
  bool store(std::uint32_t offset, std::uint64_t tick, std::uint32_t value) {
    return counters_.store(offset, static_cast<std::int64_t>(tick), value);
  }
  static bool wants_reference_clock(std::uint32_t offset, std::uint32_t value) {
    return offset < 8 && (value & TimerCounters::kReferenceClock) != 0;
  }
  void advance(std::uint64_t tick) { counters_.advance(static_cast<std::int64_t>(tick)); }
  /// Returns the tick of the timer's next event, or kNoTick if no event is due.
  std::uint64_t next_tick() const;
  void reset() { counters_.reset(); }
  void visit(state::Visitor& v) { counters_.visit(v); }

 private:
  std::int64_t never() const override;
  std::uint64_t counts(std::uint32_t config, std::int64_t from, std::int64_t to) const override;
  std::int64_t time_of(std::uint32_t config, std::int64_t since, std::uint64_t counts) const override;

  TimerCounters counters_;
};

}  // namespace mebots::soc::gap8_devices
