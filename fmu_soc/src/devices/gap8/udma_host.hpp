// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "devices/core/described_device.hpp"
#include "devices/gap8/signals.hpp"
#include "mebots/soc/device_kind.hpp"

#include <cmath>
#include <cstdint>
#include <functional>

namespace mebots::soc::gap8_devices {

/// What the uDMA does for its peripherals. Lives longer than they do.
struct UdmaHost {
  const BoardDevice& entry;
  DeviceHost& host;
  Signals& signals;
  std::function<double()> clock_hz;  // of the SoC
  DescribedDevice registers;         // that keep what is stored

  std::uint32_t config(std::uint32_t offset) {
    std::uint32_t value = 0;
    registers.load(offset, 0, value);
    return value;
  }
  /// `clocks` of the SoC after a time.
  Picoseconds later(Picoseconds time, double clocks) const {
    return time + std::llround(clocks / clock_hz() * kPsPerS);
  }
  /// What a transfer has to do with memory that is not there.
  void complain_of_memory(std::uint32_t address, std::uint32_t size) const;
};

}  // namespace mebots::soc::gap8_devices
