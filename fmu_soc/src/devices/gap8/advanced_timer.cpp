// SPDX-License-Identifier: Apache-2.0
#include "devices/gap8/advanced_timer.hpp"

#include "devices/core/kinds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace mebots::soc::gap8_devices {
namespace {

constexpr std::uint32_t kPwmTimerBytes = 0x40;
constexpr std::uint32_t kPwmCommand = 0x00;
constexpr std::uint32_t kPwmConfig = 0x04;
constexpr std::uint32_t kPwmLimits = 0x08;
constexpr std::uint32_t kPwmChannels = 0x0C;
// Look-up tables of the channels; without effect, because there are no input pads.
constexpr std::uint32_t kPwmTables = 0x1C;
constexpr std::uint32_t kPwmCounterValue = 0x2C;
constexpr std::uint32_t kPwmEventConfig = 0x100;
constexpr std::uint32_t kPwmEnable = 0x104;

constexpr std::uint32_t kPwmStart = 1U << 0;
constexpr std::uint32_t kPwmStop = 1U << 1;
constexpr std::uint32_t kPwmUpdate = 1U << 2;
constexpr std::uint32_t kPwmReset = 1U << 3;

constexpr unsigned kPwmModeShift = 8;
constexpr std::uint32_t kPwmModeMask = 7;
constexpr std::uint32_t kPwmOfReferenceClock = 1U << 11;
constexpr std::uint32_t kPwmSaw = 1U << 12;
constexpr unsigned kPwmPrescalerShift = 16;

constexpr unsigned kPwmFirstEvent = 38;
constexpr unsigned kPwmEventEnableShift = 16;
constexpr unsigned kPwmEvents = 4;

/// Operations of a channel at its threshold. A combined operation, such as kPwmSetClear, has a second part. If the
/// counter is a sawtooth, the second part takes effect at the end of the period, otherwise at the threshold during the
/// count down.
enum PwmOperation : std::uint32_t {
  kPwmSet,
  kPwmToggleClear,
  kPwmSetClear,
  kPwmToggle,
  kPwmClear,
  kPwmToggleSet,
  kPwmClearSet
};

std::uint64_t low_limit(std::uint32_t limits) {
  return limits & 0xffffU;
}
/// Returns the number of ticks from the low limit to the high limit.
std::uint64_t ticks_up_of(std::uint32_t limits) {
  const std::uint64_t high = limits >> 16;
  return high > low_limit(limits) ? high - low_limit(limits) : 0;
}

}  // namespace

AdvancedTimer::AdvancedTimer(Signals& signals, std::function<double()> clock_hz,
                             std::function<void(const char*)> complain)
    : signals_(signals), clock_hz_(std::move(clock_hz)), warn_(std::move(complain)) {
  signals.clock_changes = [this, others = signals.clock_changes](Picoseconds now) {
    others(now);
    for (std::size_t timer = 0; timer < kTimers; ++timer) settle(timer, now);
  };
}

std::uint64_t AdvancedTimer::period(const Settings& settings) {
  const auto ticks = ticks_up_of(settings.limits);
  return (settings.config & kPwmSaw) != 0 ? ticks + 1 : std::max<std::uint64_t>(2 * ticks, 1);
}

std::uint32_t AdvancedTimer::value_of(const Settings& settings, std::uint64_t ticks) {
  const auto ticks_up = ticks_up_of(settings.limits);
  auto phase = ticks % period(settings);
  if ((settings.config & kPwmSaw) == 0 && phase > ticks_up) phase = 2 * ticks_up - phase;
  return static_cast<std::uint32_t>(low_limit(settings.limits) + phase);
}

std::optional<AdvancedTimer::RisingEdges> AdvancedTimer::rising_edges(const Settings& settings, std::uint32_t channel) {
  const std::uint64_t threshold = channel & 0xffffU;
  const auto ticks_up = ticks_up_of(settings.limits);
  if (threshold < low_limit(settings.limits) || threshold - low_limit(settings.limits) > ticks_up) return std::nullopt;
  const auto there = threshold - low_limit(settings.limits);
  const bool is_saw = (settings.config & kPwmSaw) != 0;
  const auto whole = period(settings);
  const auto second = is_saw ? whole - 1 : 2 * ticks_up - there;
  switch (channel >> 16 & 7U) {
    case kPwmSet:
      return RisingEdges{there, 0};
    case kPwmToggleClear:
    case kPwmSetClear:
      return RisingEdges{there, whole};
    case kPwmToggle:  // a toggled output falls at the next threshold
      return RisingEdges{there, is_saw ? 2 * whole : whole};
    case kPwmToggleSet:
    case kPwmClearSet:
      return RisingEdges{second, whole};
    default:
      return std::nullopt;
  }
}

double AdvancedTimer::tick_hz(const Counter& counter) const {
  const auto config = counter.active.config;
  const auto hz = (config & kPwmOfReferenceClock) != 0 ? static_cast<double>(kReferenceClockHz) : clock_hz_();
  return hz / ((config >> kPwmPrescalerShift & 0xffU) + 1.0);
}

bool AdvancedTimer::counts(std::size_t timer) const {
  return counters_[timer].runs && (enabled_ >> timer & 1U) != 0;
}

std::uint64_t AdvancedTimer::ticks_at(std::size_t timer, Picoseconds now) const {
  const auto& counter = counters_[timer];
  if (!counts(timer)) return counter.ticks;
  const auto passed = static_cast<double>(now - counter.since) * tick_hz(counter) / kPsPerS;
  const auto ticks = counter.ticks + static_cast<std::uint64_t>(counter.fraction + passed);
  // Corrects a rounding error: a tick has elapsed only from the time that time_of() returns for this tick.
  return ticks > counter.ticks && time_of(counter, ticks) > now ? ticks - 1 : ticks;
}

/// Returns a time at which ticks_at() has reached `ticks`. For ticks before the last change, returns the time of that
/// change.
Picoseconds AdvancedTimer::time_of(const Counter& counter, std::uint64_t ticks) const {
  if (ticks <= counter.ticks) return counter.since;
  const auto missing = static_cast<double>(ticks - counter.ticks) - counter.fraction;
  return counter.since + static_cast<Picoseconds>(std::ceil(missing * kPsPerS / tick_hz(counter)));
}

/// Counts the ticks of a counter up to `now`. Must be called before the counter's rate changes, and when the counter
/// starts. Keeps the elapsed part of a tick.
void AdvancedTimer::settle(std::size_t timer, Picoseconds now) {
  auto& counter = counters_[timer];
  if (counts(timer)) {
    const auto passed = static_cast<double>(now - counter.since) * tick_hz(counter) / kPsPerS;
    const auto ticks = ticks_at(timer, now);
    const auto rest = counter.fraction + passed - static_cast<double>(ticks - counter.ticks);
    counter.fraction = std::clamp(rest, 0.0, std::nextafter(1.0, 0.0));
    counter.ticks = ticks;
  }
  counter.since = now;
}

bool AdvancedTimer::load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) {
  value = 0;
  if (offset == kPwmEventConfig || offset == kPwmEnable) {
    value = offset == kPwmEnable ? enabled_ : events_;
    return true;
  }
  const auto timer = offset / kPwmTimerBytes;
  const auto reg = offset % kPwmTimerBytes;
  if (timer >= kTimers) return false;
  const auto& counter = counters_[timer];
  if (reg == kPwmConfig) value = counter.stored.config;
  if (reg == kPwmLimits) value = counter.stored.limits;
  if (reg >= kPwmChannels && reg < kPwmTables) value = counter.stored.channels[(reg - kPwmChannels) / 4];
  if (reg == kPwmCounterValue) value = value_of(counter.active, ticks_at(timer, now));
  return reg <= kPwmCounterValue;
}

bool AdvancedTimer::store(std::uint32_t offset, Picoseconds now, std::uint32_t value) {
  advance(now);
  if (offset == kPwmEnable) {
    enable(value, now);
    return true;
  }
  if (offset == kPwmEventConfig) {
    events_ = value;
    // With the new configuration, only rising edges after `now` raise events.
    for (std::size_t i = 0; i < kTimers; ++i) counters_[i].raised = std::max(counters_[i].raised, ticks_at(i, now));
    return true;
  }
  const auto timer = offset / kPwmTimerBytes;
  const auto reg = offset % kPwmTimerBytes;
  if (timer >= kTimers) return false;
  auto& stored = counters_[timer].stored;
  if (reg == kPwmCommand) command(timer, value, now);
  if (reg == kPwmConfig) {
    stored.config = value;
    if ((value >> kPwmModeShift & kPwmModeMask) != 0 && !std::exchange(warned_pads_[timer], true)) {
      warn_("counting at an input pad is not modelled: the timer counts its clock instead");
    }
  }
  if (reg == kPwmLimits) stored.limits = value;
  if (reg >= kPwmChannels && reg < kPwmTables) stored.channels[(reg - kPwmChannels) / 4] = value;
  return reg < kPwmCounterValue;
}

void AdvancedTimer::enable(std::uint32_t value, Picoseconds now) {
  for (std::size_t timer = 0; timer < kTimers; ++timer) {
    if (((enabled_ ^ value) >> timer & 1U) != 0) settle(timer, now);
  }
  enabled_ = value;
}

void AdvancedTimer::command(std::size_t timer, std::uint32_t value, Picoseconds now) {
  settle(timer, now);
  auto& counter = counters_[timer];
  if ((value & kPwmUpdate) != 0 || ((value & kPwmStart) != 0 && counter.is_fresh)) {
    counter.active = counter.stored;
    counter.is_fresh = false;
  }
  if ((value & kPwmReset) != 0) {
    counter.ticks = counter.raised = 0;
    counter.fraction = 0;
  }
  if ((value & kPwmStop) != 0) counter.runs = false;
  if ((value & kPwmStart) != 0) counter.runs = true;
  counter.raised = std::max(counter.raised, counter.ticks);
}

std::optional<std::size_t> AdvancedTimer::chosen(unsigned event) const {
  if ((events_ >> (kPwmEventEnableShift + event) & 1U) == 0) return std::nullopt;
  return events_ >> 4 * event & 0xfU;
}

/// Returns the tick of the next rising edge of the output that is selected for this event. Skips edges that have
/// already raised the event.
std::optional<std::uint64_t> AdvancedTimer::next_rising_edge(unsigned event) const {
  const auto channel = chosen(event);
  if (!channel || !counts(*channel / kChannelsOfTimer)) return std::nullopt;
  const auto& counter = counters_[*channel / kChannelsOfTimer];
  const auto found = rising_edges(counter.active, counter.active.channels[*channel % kChannelsOfTimer]);
  if (!found) return std::nullopt;
  if (counter.raised < found->first) return found->first;
  if (found->step == 0) return std::nullopt;
  return found->first + ((counter.raised - found->first) / found->step + 1) * found->step;
}

Picoseconds AdvancedTimer::next_event() const {
  auto next = kNever;
  for (unsigned event = 0; event < kPwmEvents; ++event) {
    if (const auto rise = next_rising_edge(event)) {
      next = std::min(next, time_of(counters_[*chosen(event) / kChannelsOfTimer], *rise));
    }
  }
  return next;
}

void AdvancedTimer::advance(Picoseconds now) {
  for (auto time = next_event(); time <= now; time = next_event()) {
    std::array<std::uint64_t, kTimers> raised{};
    for (unsigned event = 0; event < kPwmEvents; ++event) {
      const auto rise = next_rising_edge(event);
      if (!rise) continue;
      const auto timer = *chosen(event) / kChannelsOfTimer;
      if (time_of(counters_[timer], *rise) > time) continue;
      signals_.raise_soc_event(kPwmFirstEvent + event, time);
      raised[timer] = std::max(raised[timer], *rise);
    }
    for (std::size_t timer = 0; timer < kTimers; ++timer) {
      counters_[timer].raised = std::max(counters_[timer].raised, raised[timer]);
    }
  }
}

void AdvancedTimer::visit(state::Visitor& v) {
  v("counters", counters_);
  v("events", events_);
  v("enabled", enabled_);
}

}  // namespace mebots::soc::gap8_devices

MEBOTS_CHIP_KIND(gap8_advanced_timer, {}, [](const BoardDevice& entry, ChipHost& host) -> std::unique_ptr<Device> {
  return std::make_unique<gap8_devices::AdvancedTimer>(
      host.signals(), [&host] { return host.clock_hz(); },
      [&host, name = entry.name](const char* text) { host.complain(fmt::format("{}: {}", name, text)); });
})
