// SPDX-License-Identifier: Apache-2.0
#include "devices/gap8/power_unit.hpp"

#include "devices/core/kinds.hpp"

#include <cmath>

namespace mebots::soc::gap8_devices {
namespace {

constexpr std::uint32_t kControl = 0x0;

}  // namespace

PowerUnit::PowerUnit(const BoardDevice& entry, DeviceHost& host, Signals& signals)
    : registers_(entry, host), signals_(signals), delay_(std::llround(entry.state("busy").delay_s * kPsPerS)) {}

bool PowerUnit::store(std::uint32_t offset, Picoseconds now, std::uint32_t value) {
  if (!registers_.store(offset, now, value)) return false;
  if (offset == kControl) done_at_ = now + delay_;
  return true;
}

void PowerUnit::advance(Picoseconds now) {
  if (now < done_at_) return;
  done_at_ = kNever;
  signals_.raise_soc_event(kScuOk, now);
}

void PowerUnit::visit(state::Visitor& v) {
  v("registers", registers_);
  v("done_at", done_at_);
}

}  // namespace mebots::soc::gap8_devices

MEBOTS_CHIP_KIND(gap8_power_unit, {}, gap8_devices::make_with_signals<gap8_devices::PowerUnit>)
