// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "devices/core/described_device.hpp"
#include "devices/gap8/signals.hpp"

#include <algorithm>
#include <cstdint>

namespace mebots::soc::gap8_devices {

/// Models GAP8's SoC control. The board file lists its registers. INFO contains the number of cores of this chip's
/// cluster. Stores into three other registers have effects. A store into CORESTATUS with bit 31 set ends the program;
/// the lower bits are the exit code. The low five bits of SAFE_PMU_RAR set the voltage: 550 mV plus 50 mV per step. In
/// CL_BYPASS, bit 3 switches the cluster's power, and bit 10 gates the cluster's clock. After the delay of the state
/// "switching" in the board file, SoC event 31 reports a change of bit 3, and SoC event 35 a change of bit 10.
///
/// Bit 10 has no other effect, because programs only gate the clock while no core fetches. Sources:
/// archi/chips/gap/apb_soc.h, GVSoC's apb_soc of GAP8, runtime of the published programs.
class SocControl final : public Device {
 public:
  SocControl(const BoardDevice& entry, DeviceHost& host, Signals& signals);

  bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) override;
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override;
  void advance(Picoseconds now) override;
  Picoseconds next_event() const override { return std::min(power_changes_at_, clock_changes_at_); }
  void visit(state::Visitor& v) override;

 private:
  void switch_cluster(std::uint32_t before, std::uint32_t bypass, Picoseconds now);

  DescribedDevice registers_;
  Signals& signals_;
  Picoseconds delay_;
  Picoseconds power_changes_at_ = kNever;
  Picoseconds clock_changes_at_ = kNever;
};

}  // namespace mebots::soc::gap8_devices
