// SPDX-License-Identifier: Apache-2.0
#include "devices/gap8/soc_control.hpp"

#include "devices/core/kinds.hpp"

#include <cmath>

namespace mebots::soc::gap8_devices {
namespace {

constexpr std::uint32_t kInfo = 0x0;
constexpr unsigned kInfoCoresShift = 16;
constexpr std::uint32_t kClusterBypass = 0x70;
constexpr std::uint32_t kClusterOn = 1U << 3;
constexpr std::uint32_t kClockGated = 1U << 10;
constexpr std::uint32_t kCoreStatus = 0xA0;
constexpr std::uint32_t kVoltages = 0x100;
constexpr std::uint32_t kEnded = 1U << 31;
constexpr std::uint32_t kVoltageMask = 0x1f;
constexpr std::uint32_t kLowest_mv = 550;
constexpr std::uint32_t kStep_mv = 50;

}  // namespace

SocControl::SocControl(const BoardDevice& entry, DeviceHost& host, Signals& signals)
    : registers_(entry, host), signals_(signals), delay_(std::llround(entry.state("switching").delay_s * kPsPerS)) {
  std::uint32_t voltages = 0;
  if (registers_.load(kVoltages, 0, voltages)) {
    signals.power->voltage_mv = kLowest_mv + kStep_mv * (voltages & kVoltageMask);
  }
}

bool SocControl::load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) {
  if (!registers_.load(offset, now, value)) return false;
  if (offset == kInfo) value = signals_.cluster_cores << kInfoCoresShift | (signals_.cluster_cores == 0 ? 0 : 1);
  return true;
}

bool SocControl::store(std::uint32_t offset, Picoseconds now, std::uint32_t value) {
  std::uint32_t before = 0;
  if (offset == kClusterBypass) registers_.load(offset, now, before);
  if (!registers_.store(offset, now, value)) return false;
  if (offset == kClusterBypass) {
    switch_cluster(before, value, now);
  } else if (offset == kCoreStatus && (value & kEnded) != 0 && !signals_.exit_code) {
    signals_.exit_code = static_cast<std::int32_t>(value & ~kEnded);
  } else if (offset == kVoltages) {
    signals_.power->voltage_mv = kLowest_mv + kStep_mv * (value & kVoltageMask);
  }
  return true;
}

void SocControl::switch_cluster(std::uint32_t before, std::uint32_t bypass, Picoseconds now) {
  const auto changed = before ^ bypass;
  if ((changed & kClusterOn) != 0) {
    signals_.power->cluster_on = (bypass & kClusterOn) != 0 ? 1 : 0;
    power_changes_at_ = now + delay_;
  }
  if ((changed & kClockGated) != 0) clock_changes_at_ = now + delay_;
}

void SocControl::advance(Picoseconds now) {
  if (now >= power_changes_at_) {
    power_changes_at_ = kNever;
    signals_.raise_soc_event(kClusterPowerChanged, now);
  }
  if (now >= clock_changes_at_) {
    clock_changes_at_ = kNever;
    signals_.raise_soc_event(kClusterClockChanged, now);
  }
}

void SocControl::visit(state::Visitor& v) {
  v("registers", registers_);
  v("power_changes_at", power_changes_at_);
  v("clock_changes_at", clock_changes_at_);
}

}  // namespace mebots::soc::gap8_devices

MEBOTS_CHIP_KIND(gap8_soc_control, {}, gap8_devices::make_with_signals<gap8_devices::SocControl>)
