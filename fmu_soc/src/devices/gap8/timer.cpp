// SPDX-License-Identifier: Apache-2.0
#include "devices/gap8/timer.hpp"

#include "cluster/peripherals.hpp"
#include "devices/core/kinds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace mebots::soc::gap8_devices {

namespace {

constexpr std::uint32_t kEnable = 1U << 0;
constexpr std::uint32_t kReset = 1U << 1;
constexpr std::uint32_t kInterrupt = 1U << 2;
constexpr std::uint32_t kClearAtCompare = 1U << 4;
constexpr std::uint32_t kOneShot = 1U << 5;
constexpr std::uint32_t kPrescaler = 1U << 6;
constexpr std::uint32_t kPair = 1U << 31;

// Each register exists twice: first for the low counter, then for the high counter.
constexpr unsigned kConfig = 0;
constexpr unsigned kCount = 1;
constexpr unsigned kCompare = 2;
constexpr unsigned kStart = 3;

}  // namespace

std::uint32_t TimerCounters::divider_of(std::uint32_t config) {
  return (config & kPrescaler) != 0 ? (config >> 8 & 0xffU) + 1 : 1;
}

bool TimerCounters::is_pair() const {
  return (counters_[0].config & kPair) != 0;
}

std::uint64_t TimerCounters::target_of(unsigned index) const {
  if (!is_pair()) return counters_[index].compare;
  return std::uint64_t{counters_[1].compare} << 32 | counters_[0].compare;
}

void TimerCounters::count_one(Counter& counter, std::int64_t now) {
  if ((counter.config & kEnable) == 0) {
    counter.since = now;
    return;
  }
  const auto passed = clock_.counts(counter.config, counter.since, now);
  if (passed == 0) return;  // the elapsed part of a count is kept
  counter.value = (counter.value + passed) & width_mask();
  if (counter.value != counter.compared_at) counter.met = false;
  counter.since = (counter.config & kReferenceClock) != 0
                      ? now
                      : std::min(now, clock_.time_of(counter.config, counter.since, passed));
}

void TimerCounters::count(std::int64_t now) {
  count_one(counters_[0], now);
  if (is_pair()) {
    counters_[1].since = now;  // the high counter counts alone from now on
  } else {
    count_one(counters_[1], now);
  }
}

/// If the counter has reached its compare value, restarts the counter, raises its event and stops it, each only if the
/// configuration selects it.
void TimerCounters::compare(unsigned index) {
  auto& counter = counters_[index];
  if ((counter.config & kEnable) == 0 || counter.met || counter.value != target_of(index)) return;
  counter.met = true;
  counter.compared_at = counter.value;
  if ((counter.config & kClearAtCompare) != 0) {
    counter.value = 0;
    counter.met = target_of(index) == 0;
  }
  if ((counter.config & kInterrupt) != 0) raise_(index);
  if ((counter.config & kOneShot) != 0) counter.config &= ~kEnable;
}

void TimerCounters::configure(unsigned index, std::uint32_t config) {
  auto& counter = counters_[index];
  const bool was_pair = is_pair();
  counter.config = config & ~kReset & (index == 0 ? ~0U : ~kPair);
  if (is_pair() != was_pair) pair_or_split();
  if ((config & kReset) != 0) {
    counter.value = 0;
    counter.met = false;
  }
}

/// Joins the counters to one 64-bit counter (a pair), or splits the pair. The registers keep their values; the high
/// counter is the upper half of a pair.
void TimerCounters::pair_or_split() {
  auto& low = counters_[0];
  auto& high = counters_[1];
  if (is_pair()) {
    low.value |= high.value << 32;
  } else {
    high.value = low.value >> 32;
    low.value &= 0xffffffffU;
  }
  low.met = false;
  high.met = false;
}

bool TimerCounters::load(std::uint32_t offset, std::int64_t now, std::uint32_t& value) {
  count(now);
  const auto index = offset / 4 % 2;
  const auto& counter = counters_[index];
  switch (offset / 8) {
    case kConfig:
      value = counter.config;
      return true;
    case kCount:
      value = static_cast<std::uint32_t>(is_pair() ? counters_[0].value >> (32 * index) : counter.value);
      return true;
    case kCompare:
      value = counter.compare;
      return true;
    default:
      return false;
  }
}

bool TimerCounters::store(std::uint32_t offset, std::int64_t now, std::uint32_t value) {
  count(now);
  const auto index = offset / 4 % 2;
  auto& counter = counters_[index];
  // In a pair, the low counter stores the 64-bit value, and whether this value has reached the compare value (`met`).
  const auto owner = is_pair() ? 0U : index;
  if (offset >= kSpan) return false;
  switch (offset / 8) {
    case kConfig:
      configure(index, value);
      counter.since = now;
      break;
    case kCount:
      if (is_pair()) {
        const auto shift = 32 * index;
        counters_[0].value = (counters_[0].value & ~(std::uint64_t{0xffffffff} << shift)) | std::uint64_t{value}
                                                                                                << shift;
      } else {
        counter.value = value;
      }
      counters_[owner].met = false;
      counters_[owner].since = now;
      break;
    case kCompare:
      counter.compare = value;
      counters_[owner].met = false;
      break;
    case kStart:
      configure(index, counter.config | kEnable);
      counter.since = now;
      break;
    default:
      configure(index, counter.config | kReset);
      counter.since = now;
      break;
  }
  compare(owner);
  return true;
}

void TimerCounters::advance(std::int64_t now) {
  count(now);
  compare(0);
  if (!is_pair()) compare(1);
}

std::int64_t TimerCounters::next_event() const {
  auto next = clock_.never();
  for (unsigned index = 0; index < (is_pair() ? 1U : 2U); ++index) {
    const auto& counter = counters_[index];
    const bool matters = (counter.config & (kInterrupt | kClearAtCompare | kOneShot)) != 0;
    if ((counter.config & kEnable) == 0 || !matters) continue;
    auto left = (target_of(index) - counter.value) & width_mask();
    if (left == 0) left = counter.met ? width_mask() : 0;
    next = std::min(next, clock_.time_of(counter.config, counter.since, left));
  }
  return next;
}

namespace {

/// An event that is more than this number of counts ahead is treated as never, because no mission lasts until then.
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

namespace {

/// An event that is more than this number of ticks ahead is treated as never, because no mission lasts until then.
constexpr std::int64_t kFarTicks = std::int64_t{1} << 56;

}  // namespace

std::uint64_t ClusterTimer::next_tick() const {
  const auto next = counters_.next_event();
  return next == never() ? kNoTick : static_cast<std::uint64_t>(next);
}

std::int64_t ClusterTimer::never() const {
  return std::numeric_limits<std::int64_t>::max();
}

std::uint64_t ClusterTimer::counts(std::uint32_t config, std::int64_t from, std::int64_t to) const {
  if ((config & TimerCounters::kReferenceClock) != 0) return 0;
  return static_cast<std::uint64_t>(to - from) / TimerCounters::divider_of(config);
}

std::int64_t ClusterTimer::time_of(std::uint32_t config, std::int64_t since, std::uint64_t counts) const {
  const auto divider = TimerCounters::divider_of(config);
  const bool stands = (config & TimerCounters::kReferenceClock) != 0;
  if (stands || counts > static_cast<std::uint64_t>(kFarTicks) / divider) return never();
  return since + static_cast<std::int64_t>(counts * divider);
}

}  // namespace mebots::soc::gap8_devices

MEBOTS_CHIP_KIND(gap8_timer, {}, [](const BoardDevice& /*entry*/, ChipHost& host) -> std::unique_ptr<Device> {
  return std::make_unique<gap8_devices::Timer>(host.signals(), [&host] { return host.clock_hz(); });
})
