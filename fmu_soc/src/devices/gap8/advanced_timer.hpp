// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "devices/gap8/signals.hpp"
#include "mebots/soc/device.hpp"

#include <array>
#include <cstdint>
#include <functional>
#include <optional>

namespace mebots::soc::gap8_devices {

/// Models GAP8's advanced timer (PWM): four 16-bit counters with four channels each. A channel sets, clears or toggles
/// its output when the counter reaches the channel's threshold. A counter counts from its low to its high limit, and
/// then starts again or counts down. Outputs are not connected to pads, but up to four of them raise SoC events at
/// their rising edges. Counting at edges of input pads is not modelled; a program that uses it is reported.
///
/// Sources: archi/pwm/pwm_v1.h of GreenWaves' gap_sdk; bits of commands, configuration and events: pulp-platform's
/// apb_adv_timer.
class AdvancedTimer final : public Device {
 public:
  /// `clock_hz` returns the present clock of the SoC. `complain` receives reports about features that are not modelled.
  AdvancedTimer(Signals& signals, std::function<double()> clock_hz, std::function<void(const char*)> complain);

  bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) override;
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override;
  void advance(Picoseconds now) override;
  Picoseconds next_event() const override;
  void visit(state::Visitor& v) override;

 private:
  static constexpr std::size_t kTimers = 4;
  static constexpr std::size_t kChannelsOfTimer = 4;

  struct Settings {
    std::uint32_t config = 0;
    std::uint32_t limits = 0;
    std::array<std::uint32_t, kChannelsOfTimer> channels{};

    void visit(state::Visitor& v) {
      v("config", config);
      v("limits", limits);
      v("channels", channels);
    }
  };
  struct Counter {
    Settings stored;
    Settings active;  // settings that the last update command copied from `stored`
    bool runs = false;
    Picoseconds since = 0;
    std::uint64_t ticks = 0;   // number of ticks at the time `since`
    double fraction = 0;       // elapsed part of the next tick at the time `since`
    std::uint64_t raised = 0;  // number of ticks for which events have been raised
    bool is_fresh = true;      // true until the first update or start; the first start copies the stored settings

    void visit(state::Visitor& v) {
      v("stored", stored);
      v("active", active);
      v("runs", runs);
      v("since", since);
      v("ticks", ticks);
      v("fraction", fraction);
      v("told", raised);
      v("is_fresh", is_fresh);
    }
  };
  /// Describes the ticks at which a channel's output rises: first at tick `first`, then every `step` ticks.
  struct RisingEdges {
    std::uint64_t first;
    std::uint64_t step;  // 0: the output rises once
  };

  static std::uint64_t period(const Settings& settings);
  static std::optional<RisingEdges> rising_edges(const Settings& settings, std::uint32_t channel);
  static std::uint32_t value_of(const Settings& settings, std::uint64_t ticks);
  double tick_hz(const Counter& counter) const;
  bool counts(std::size_t timer) const;
  std::uint64_t ticks_at(std::size_t timer, Picoseconds now) const;
  Picoseconds time_of(const Counter& counter, std::uint64_t ticks) const;
  void settle(std::size_t timer, Picoseconds now);
  void enable(std::uint32_t value, Picoseconds now);
  void command(std::size_t timer, std::uint32_t value, Picoseconds now);
  /// Returns the index of the channel that raises event `event`, or nullopt if the event is off.
  std::optional<std::size_t> chosen(unsigned event) const;
  std::optional<std::uint64_t> next_rising_edge(unsigned event) const;

  Signals& signals_;
  std::function<double()> clock_hz_;
  std::function<void(const char*)> warn_;
  std::array<Counter, kTimers> counters_;
  std::uint32_t events_ = 0;
  std::uint32_t enabled_ = 0;
  /// True for counters whose use of an input pad was reported. Not part of a saved state.
  std::array<bool, kTimers> warned_pads_{};
};

}  // namespace mebots::soc::gap8_devices
