// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

/// Folders to start from, made of templates/ of the build or installation. Each builds and runs as it is, against an
/// installed MEbots. All throw Error: for a name that cannot be used, and for a folder that is there already, since
/// nothing is ever overwritten.
namespace mebots::new_folder {

/// A bare-metal program for the chip: main.c, CMakeLists.txt, README.md. `folder` empty = the name, in the working
/// folder. Returns the folder.
std::filesystem::path new_firmware(const std::string& name, std::filesystem::path folder);

struct Sensor {
  std::string name;
  /// What it senses in the mission: a Real output of its instances world, motors or battery.
  std::string senses = "world.range.down";
  /// The board that gets the sensor; empty = GAP8 alone.
  std::filesystem::path board;
  /// With a device model in C++ instead of states in the board file alone.
  bool with_code = false;
};

/// A device of the board's own with driver, firmware, chip FMU and mission.
std::filesystem::path new_sensor(const Sensor& sensor, std::filesystem::path folder);

}  // namespace mebots::new_folder
