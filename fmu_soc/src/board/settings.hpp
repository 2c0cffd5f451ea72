// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cluster/peripherals.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

namespace mebots::soc {

struct Settings {
  double clock_hz = 100e6;
  double cluster_clock_hz = 87e6;
  // Number of cores in the cluster, at most the board's number.
  unsigned cluster_cores = kMostClusterCores;
  double temperature_c = 25;
  double voltage_v = 1.2;
  /// Folders that are searched for the board's libraries, after the folder of the board file.
  std::vector<std::filesystem::path> library_folders = {};
  std::vector<std::uint8_t> flash = {};  // initial contents of the board's flash
  /// Pictures that the board's camera takes, in this order. If the list is empty, the camera takes pictures from the
  /// FMU's input.
  std::vector<std::vector<std::uint8_t>> pictures = {};
  bool translate = true;  // true: hot code is translated; results do not depend on this setting
  /// Value of HartSettings::keeps_written_mtvec for the fabric controller.
  bool keeps_written_mtvec = false;
};

/// A parameter of the chip that firmware can read through a register of a device that has no C++ code.
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
