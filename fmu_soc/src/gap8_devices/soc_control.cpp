// SPDX-License-Identifier: Apache-2.0
#include "gap8_devices/soc_control.hpp"

namespace mebots::soc::gap8_devices {
namespace {

constexpr std::uint32_t kCoreStatus = 0xA0;
constexpr std::uint32_t kVoltages = 0x100;
constexpr std::uint32_t kEnded = 1U << 31;
constexpr std::uint32_t kVoltageMask = 0x1f;
constexpr std::uint32_t kLowest_mv = 550;
constexpr std::uint32_t kStep_mv = 50;

}  // namespace

SocControl::SocControl(const BoardDevice& entry, DeviceHost& host, Signals& signals)
    : registers_(entry, host), signals_(signals) {
  std::uint32_t voltages = 0;
  if (registers_.load(kVoltages, 0, voltages)) {
    signals.power->voltage_mv = kLowest_mv + kStep_mv * (voltages & kVoltageMask);
  }
}

bool SocControl::store(std::uint32_t offset, Picoseconds now, std::uint32_t value) {
  if (!registers_.store(offset, now, value)) return false;
  if (offset == kCoreStatus && (value & kEnded) != 0) {
    signals_.exit_code = static_cast<std::int32_t>(value & ~kEnded);
  } else if (offset == kVoltages) {
    signals_.power->voltage_mv = kLowest_mv + kStep_mv * (value & kVoltageMask);
  }
  return true;
}

}  // namespace mebots::soc::gap8_devices
