// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "devices/readings.hpp"
#include "fmu_soc_board/board.hpp"
#include "mebots/soc/fixed_point.hpp"

namespace mebots::soc {

/// Bus voltage and state of charge.
class BatteryGauge final : public Readings<board::battery::kRegisters.size()> {
 public:
  void set_voltage_v(double voltage_v) { set(board::battery::kVoltage, to_register(voltage_v, kMilli)); }
  void set_state_of_charge(double share) { set(board::battery::kStateOfCharge, to_register(share, kMicro)); }
};

}  // namespace mebots::soc
