// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "devices/gap8/signals.hpp"
#include "devices/gap8/timer_counters.hpp"
#include "mebots/soc/device.hpp"

#include <cstdint>
#include <functional>

namespace mebots::soc::gap8_devices {

/// GAP8's timer of the fabric controller. Its counters count the controller's clock or the reference clock.
class Timer final : public Device, private TimerClock {
 public:
  /// `clock_hz`: of the fabric controller, now.
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

}  // namespace mebots::soc::gap8_devices
