// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "devices/described_device.hpp"
#include "gap8_devices/signals.hpp"

#include <cstdint>

namespace mebots::soc::gap8_devices {

/// GAP8's SoC control: registers as its entry describes them, of which two do something. CORESTATUS with bit 31 ends
/// the program with the code in the bits below; the low five bits of SAFE_PMU_RAR set the voltage, 550 mV and 50 mV a
/// step. Source: archi/chips/gap/apb_soc.h, runtime of the published programs.
class SocControl final : public Device {
 public:
  SocControl(const BoardDevice& entry, DeviceHost& host, Signals& signals);

  bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) override {
    return registers_.load(offset, now, value);
  }
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override;
  void visit(state::Visitor& v) override { registers_.visit(v); }

 private:
  DescribedDevice registers_;
  Signals& signals_;
};

}  // namespace mebots::soc::gap8_devices
