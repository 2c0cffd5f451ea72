// SPDX-License-Identifier: Apache-2.0
#include "devices/gap8/fll.hpp"

#include "devices/core/kinds.hpp"

#include <fmt/format.h>

namespace mebots::soc::gap8_devices {
namespace {

constexpr std::size_t kFllStatus = 0;
constexpr std::size_t kConfig1 = 1;

/// Values after reset: factor 1525 (49.97 MHz), divider 1. They determine the frequency after reset. On silicon, the
/// loop is open after reset, and its oscillator differs from chip to chip. Source: archi/fll/fll_v1.h.
constexpr std::uint32_t kResetConfig1 = 0x452105F5;
constexpr std::uint32_t kResetConfig2 = 0x81004107;
constexpr std::uint32_t kFactorMask = 0xffff;
constexpr unsigned kDividerShift = 26;
constexpr std::uint32_t kDividerMask = 0xf;

}  // namespace

Fll::Fll(const BoardDevice& entry, DeviceHost& host, Signals& signals) : entry_(entry), host_(host), signals_(signals) {
  registers_.fill({0, kResetConfig1, kResetConfig2, 0});
  signals.power->clock_hz = frequency_hz(0);
  signals.power->cluster_clock_hz = frequency_hz(1);
}

std::uint32_t Fll::frequency_hz(std::size_t loop) const {
  const auto config = registers_[loop][kConfig1];
  const auto divider = config >> kDividerShift & kDividerMask;
  const auto undivided = std::uint64_t{config & kFactorMask} * kReferenceClockHz;
  return static_cast<std::uint32_t>(divider > 1 ? undivided >> (divider - 1) : undivided);
}

bool Fll::load(std::uint32_t offset, Picoseconds /*now*/, std::uint32_t& value) {
  const auto loop = offset / 4 / kRegisters;
  const auto index = offset / 4 % kRegisters;
  if (loop >= kLoops) return false;
  value = index == kFllStatus ? registers_[loop][kConfig1] & kFactorMask : registers_[loop][index];
  return true;
}

bool Fll::store(std::uint32_t offset, Picoseconds now, std::uint32_t value) {
  const auto loop = offset / 4 / kRegisters;
  const auto index = offset / 4 % kRegisters;
  if (loop >= kLoops || index == kFllStatus) return false;
  const auto before = registers_[loop][index];
  registers_[loop][index] = value;
  if (index != kConfig1) return true;
  const auto hz = frequency_hz(loop);
  if (hz == 0) {
    registers_[loop][index] = before;
    host_.complain(fmt::format("{}: factor 0 would stop the clock: nothing was changed", entry_.name));
    return true;
  }
  if (loop == 0) signals_.clock_changes(now);
  (loop == 0 ? signals_.power->clock_hz : signals_.power->cluster_clock_hz) = hz;
  return true;
}

}  // namespace mebots::soc::gap8_devices

MEBOTS_CHIP_KIND(gap8_fll, {}, gap8_devices::make_with_signals<gap8_devices::Fll>)
