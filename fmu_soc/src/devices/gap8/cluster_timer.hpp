// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "devices/gap8/timer_counters.hpp"

#include <cstdint>
#include <functional>
#include <utility>

namespace mebots::soc::gap8_devices {

/// The timer that all cores of GAP8's cluster share. It counts the cluster's ticks, in which it is told time. The
/// reference clock, which a counter can be set to, is not modelled: such a counter stands still.
class ClusterTimer : private TimerClock {
 public:
  explicit ClusterTimer(std::function<void(unsigned counter)> raise) : counters_(*this, std::move(raise)) {}

  bool load(std::uint32_t offset, std::uint64_t tick, std::uint32_t& value) {
    return counters_.load(offset, static_cast<std::int64_t>(tick), value);
  }
  bool store(std::uint32_t offset, std::uint64_t tick, std::uint32_t value) {
    return counters_.store(offset, static_cast<std::int64_t>(tick), value);
  }
  /// Whether what was stored there asks for the reference clock.
  static bool wants_reference_clock(std::uint32_t offset, std::uint32_t value) {
    return offset < 8 && (value & TimerCounters::kReferenceClock) != 0;
  }
  void advance(std::uint64_t tick) { counters_.advance(static_cast<std::int64_t>(tick)); }
  /// The tick of its next event; kNoTick when there is none.
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
