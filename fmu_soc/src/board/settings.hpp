// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cluster/peripherals.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

namespace mebots::soc {

/// The settings that a chip starts with.
struct Settings {
  double clock_hz = 100e6;
  double cluster_clock_hz = 87e6;
  unsigned cluster_cores = kMostClusterCores;  // must not exceed that of the board
  double temperature_c = 25;
  double voltage_v = 1.2;
  /// Folders with libraries of the board. The folder of the board's file is searched first.
  std::vector<std::filesystem::path> library_folders = {};
  std::vector<std::uint8_t> flash = {};  // initial content of the board's flash
  /// Pictures that the board's camera takes, in this order. If empty, the camera input of the FMU supplies them.
  std::vector<std::vector<std::uint8_t>> pictures = {};
  bool translate = true;  // translate hot code; the counts are the same without
  /// Value of HartSettings::keeps_written_mtvec for the fabric controller.
  bool keeps_written_mtvec = false;
};

/// A parameter of the chip that a register of a described device can show.
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
