// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "devices/core/described_device.hpp"
#include "devices/gap8/signals.hpp"

#include <cstdint>

namespace mebots::soc::gap8_devices {

/// GAP8's power management unit: registers as its entry describes them. A store into PICL_CTRL starts a sequence of the
/// power controller; when its delay is over (the entry's state "busy"), event SCU_OK tells the fabric controller.
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

}  // namespace mebots::soc::gap8_devices
