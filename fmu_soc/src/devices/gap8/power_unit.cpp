// SPDX-License-Identifier: Apache-2.0
#include "devices/core/described_device.hpp"
#include "devices/core/kinds.hpp"
#include "devices/gap8/signals.hpp"

#include <cmath>
#include <cstdint>

namespace mebots::soc::gap8_devices {
namespace {

/// Models GAP8's power management unit. The board file lists the registers. A store into PICL_CTRL starts a sequence of
/// the power controller. After the delay of the state "busy", this sequence raises the SoC event SCU_OK.
class PowerUnit final : public Device {
 public:
  PowerUnit(const BoardDevice& entry, DeviceHost& host, Signals& signals);

  bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) override {
    return registers_.load(offset, now, value);
  }
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override;
  void advance(Picoseconds now) override;
  Picoseconds next_event() const override { return done_at_; }
  void visit(state::Visitor& v) override;

 private:
  DescribedDevice registers_;
  Signals& signals_;
  Picoseconds delay_;
  Picoseconds done_at_ = kNever;
};

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
