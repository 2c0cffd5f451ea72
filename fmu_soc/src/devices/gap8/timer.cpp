// SPDX-License-Identifier: Apache-2.0
#include "devices/gap8/timer.hpp"

#include "devices/core/kinds.hpp"

#include <cmath>
#include <utility>

namespace mebots::soc::gap8_devices {
namespace {

/// More are further away than a mission lasts.
constexpr std::uint64_t kFarCounts = std::uint64_t{1} << 48;

}  // namespace

Timer::Timer(Signals& signals, std::function<double()> clock_hz)
    : clock_hz_(std::move(clock_hz)), counters_(*this, [&signals](unsigned counter) {
        signals.raise_fabric_event(counter == 0 ? kTimerLowEvent : kTimerHighEvent);
      }) {
  signals.clock_changes = [this, others = signals.clock_changes](Picoseconds now) {
    others(now);
    counters_.count(now);
  };
}

std::uint64_t Timer::counts(std::uint32_t config, Picoseconds from, Picoseconds to) const {
  if ((config & TimerCounters::kReferenceClock) != 0) {
    return static_cast<std::uint64_t>(reference_edges(to) - reference_edges(from));
  }
  const auto cycles = static_cast<double>(to - from) * clock_hz_() / kPsPerS;
  return static_cast<std::uint64_t>(cycles + 1e-6) / TimerCounters::divider_of(config);
}

Picoseconds Timer::time_of(std::uint32_t config, Picoseconds since, std::uint64_t counts) const {
  if (counts > kFarCounts) return kNever;
  if ((config & TimerCounters::kReferenceClock) != 0) {
    return reference_edge_time(reference_edges(since) + static_cast<std::int64_t>(counts));
  }
  const auto seconds = static_cast<double>(counts) * TimerCounters::divider_of(config) / clock_hz_();
  if (seconds * kPsPerS >= static_cast<double>(kNever - since) / 2) return kNever;
  return since + static_cast<Picoseconds>(std::ceil(seconds * kPsPerS));
}

}  // namespace mebots::soc::gap8_devices

MEBOTS_CHIP_KIND(gap8_timer, {}, [](const BoardDevice& /*entry*/, ChipHost& host) -> std::unique_ptr<Device> {
  return std::make_unique<gap8_devices::Timer>(host.signals(), [&host] { return host.clock_hz(); });
})
