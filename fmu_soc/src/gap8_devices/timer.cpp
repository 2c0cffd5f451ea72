// SPDX-License-Identifier: Apache-2.0
#include "gap8_devices/timer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mebots::soc::gap8_devices {
namespace {

constexpr std::uint32_t kEnable = 1U << 0;
constexpr std::uint32_t kReset = 1U << 1;
constexpr std::uint32_t kInterrupt = 1U << 2;
constexpr std::uint32_t kClearAtCompare = 1U << 4;
constexpr std::uint32_t kOneShot = 1U << 5;
constexpr std::uint32_t kPrescaler = 1U << 6;
constexpr std::uint32_t kReferenceClock = 1U << 7;
constexpr std::uint32_t kPair = 1U << 31;

constexpr unsigned kConfig = 0;
constexpr unsigned kCount = 1;
constexpr unsigned kCompare = 2;
constexpr unsigned kStart = 3;
constexpr unsigned kClear = 4;
constexpr unsigned kGroups = 5;  // of two registers each, the low counter's and the high one's

/// More are further away than a mission lasts.
constexpr std::uint64_t kFarTicks = std::uint64_t{1} << 48;

constexpr std::array<unsigned, 2> kEvents{kTimerLowEvent, kTimerHighEvent};

std::uint32_t divider_of(std::uint32_t config) {
  return (config & kPrescaler) != 0 ? (config >> 8 & 0xffU) + 1 : 1;
}

}  // namespace

Timer::Timer(Signals& signals, std::function<double()> clock_hz) : signals_(signals), clock_hz_(std::move(clock_hz)) {
  signals.clock_changes = [this, others = signals.clock_changes](Picoseconds now) {
    others(now);
    count_all(now);
  };
}

bool Timer::is_pair() const {
  return (counters_[0].config & kPair) != 0;
}

/// Of the counter's clock, between two times.
std::uint64_t Timer::ticks(const Counter& counter, Picoseconds from, Picoseconds to) const {
  if ((counter.config & kReferenceClock) != 0) {
    return static_cast<std::uint64_t>(reference_edges(to) - reference_edges(from));
  }
  const auto cycles = static_cast<double>(to - from) * clock_hz_() / kPsPerS;
  return static_cast<std::uint64_t>(cycles + 1e-6) / divider_of(counter.config);
}

/// When it has counted so many more.
Picoseconds Timer::time_of(const Counter& counter, std::uint64_t ticks) const {
  if (ticks > kFarTicks) return kNever;
  if ((counter.config & kReferenceClock) != 0) {
    return reference_edge_time(reference_edges(counter.since) + static_cast<std::int64_t>(ticks));
  }
  const auto seconds = static_cast<double>(ticks) * divider_of(counter.config) / clock_hz_();
  if (seconds * kPsPerS >= static_cast<double>(kNever - counter.since) / 2) return kNever;
  return counter.since + static_cast<Picoseconds>(std::ceil(seconds * kPsPerS));
}

std::uint64_t Timer::target_of(unsigned index) const {
  if (!is_pair()) return counters_[index].compare;
  return std::uint64_t{counters_[1].compare} << 32 | counters_[0].compare;
}

void Timer::count(unsigned index, Picoseconds now) {
  auto& counter = counters_[index];
  if ((counter.config & kEnable) == 0) {
    counter.since = now;
    return;
  }
  const auto passed = ticks(counter, counter.since, now);
  if (passed == 0) return;  // part of a tick stays
  counter.value = (counter.value + passed) & width_mask();
  if (counter.value != counter.compared_at) counter.met = false;
  counter.since = (counter.config & kReferenceClock) != 0 ? now : std::min(now, time_of(counter, passed));
}

void Timer::count_all(Picoseconds now) {
  count(0, now);
  if (!is_pair()) count(1, now);
}

/// What happens at the value of the comparison.
void Timer::compare(unsigned index) {
  auto& counter = counters_[index];
  if ((counter.config & kEnable) == 0 || counter.met || counter.value != target_of(index)) return;
  counter.met = true;
  counter.compared_at = counter.value;
  if ((counter.config & kClearAtCompare) != 0) {
    counter.value = 0;
    counter.met = target_of(index) == 0;
  }
  if ((counter.config & kInterrupt) != 0) signals_.raise_fabric_event(kEvents[index]);
  if ((counter.config & kOneShot) != 0) counter.config &= ~kEnable;
}

void Timer::configure(unsigned index, std::uint32_t config) {
  auto& counter = counters_[index];
  if ((config & kReset) != 0) {
    counter.value = 0;
    counter.met = false;
  }
  counter.config = config & ~kReset & (index == 0 ? ~0U : ~kPair);
}

bool Timer::load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) {
  count_all(now);
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

bool Timer::store(std::uint32_t offset, Picoseconds now, std::uint32_t value) {
  count_all(now);
  const auto index = offset / 4 % 2;
  auto& counter = counters_[index];
  if (offset / 8 >= kGroups) return false;
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
      counter.met = false;
      counter.since = now;
      break;
    case kCompare:
      counter.compare = value;
      counter.met = false;
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
  compare(index);
  return true;
}

void Timer::advance(Picoseconds now) {
  count_all(now);
  compare(0);
  if (!is_pair()) compare(1);
}

Picoseconds Timer::next_event() const {
  auto next = kNever;
  for (unsigned index = 0; index < (is_pair() ? 1U : 2U); ++index) {
    const auto& counter = counters_[index];
    const bool matters = (counter.config & (kInterrupt | kClearAtCompare | kOneShot)) != 0;
    if ((counter.config & kEnable) == 0 || !matters) continue;
    auto left = (target_of(index) - counter.value) & width_mask();
    if (left == 0) left = counter.met ? width_mask() : 0;
    next = std::min(next, time_of(counter, left));
  }
  return next;
}

void Timer::visit(state::Visitor& v) {
  v("counters", counters_);
}

}  // namespace mebots::soc::gap8_devices
