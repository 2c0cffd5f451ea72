// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "soc.hpp"

#include <array>
#include <string_view>

namespace mebots::soc {

/// A parameter of the chip that a described device's register can show.
struct ChipSetting {
  std::string_view variable;
  double Settings::*value;
};

inline constexpr std::array<ChipSetting, 3> kChipSettings = {{
    {"core.clock", &Settings::clock_hz},
    {"cluster.clock", &Settings::cluster_clock_hz},
    {"core.supply_voltage", &Settings::voltage_v},
}};

}  // namespace mebots::soc
