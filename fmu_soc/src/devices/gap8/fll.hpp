// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "devices/gap8/signals.hpp"
#include "mebots/soc/device_kind.hpp"

#include <array>
#include <cstdint>

namespace mebots::soc::gap8_devices {

/// Models GAP8's two frequency-locked loops: one for the SoC with the fabric controller, and one for the cluster. A
/// loop has four registers: status, two configurations, and integrator. Its clock is the reference clock times the
/// factor of CONFIG1, divided by 2^(divider - 1). The modelled loop locks at once, because we found no source for
/// silicon's time. Source: archi/fll/fll_v1.h.
class Fll final : public Device {
 public:
  Fll(const BoardDevice& entry, DeviceHost& host, Signals& signals);

  bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) override;
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override;
  void visit(state::Visitor& v) override { v("registers", registers_); }

 private:
  static constexpr std::size_t kLoops = 2;
  static constexpr std::size_t kRegisters = 4;

  std::uint32_t frequency_hz(std::size_t loop) const;

  const BoardDevice& entry_;
  DeviceHost& host_;
  Signals& signals_;
  std::array<std::array<std::uint32_t, kRegisters>, kLoops> registers_;
};

}  // namespace mebots::soc::gap8_devices
