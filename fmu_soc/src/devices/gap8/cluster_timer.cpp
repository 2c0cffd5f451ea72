// SPDX-License-Identifier: Apache-2.0
#include "devices/gap8/cluster_timer.hpp"

#include "cluster/peripherals.hpp"

#include <limits>

namespace mebots::soc::gap8_devices {
namespace {

/// More ticks than a mission has.
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
