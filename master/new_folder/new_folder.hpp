// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

/// Creates folders from the templates/ of the build or installation. Each builds and runs unchanged with an installed
/// MEbots. All functions throw Error for an invalid name. They also throw it for an existing folder, so that nothing is
/// overwritten.
namespace mebots::new_folder {

enum class Language : std::uint8_t { c, rust };

/// Writes a bare-metal program for the chip: main.c or main.rs, CMakeLists.txt, README.md. If `folder` is empty, writes
/// into the folder of this name in the working folder. Returns the folder.
std::filesystem::path new_firmware(const std::string& name, Language language, std::filesystem::path folder);

struct Sensor {
  std::string name;
  /// The measured variable of the mission: a Real output of its instances world, motors or battery.
  std::string senses = "world.range.down";
  /// The board that gets the sensor. If it is empty, this is GAP8 without other devices.
  std::filesystem::path board;
  /// Adds a device model in C++ to the states in the board file.
  bool with_code = false;
};

/// Writes a new device for a board, with driver, firmware, chip FMU and mission.
std::filesystem::path new_sensor(const Sensor& sensor, std::filesystem::path folder);

/// Words of a template and their replacements, in file names and texts.
using Words = std::vector<std::pair<std::string, std::string>>;

/// The files of a template: relative path and text.
using Files = std::vector<std::pair<std::filesystem::path, std::string>>;

/// Reads templates/`name` with its words replaced, by path.
Files read_template(const std::string& name, const Words& words);

/// Throws Error unless `name` can be the name of a C function, a device and a CMake target: lower-case letters, digits
/// and _, and none of the templates' own words.
void require_name(const std::string& name);

/// Writes the files into a new folder. Throws Error if it exists.
void write_folder(const std::filesystem::path& folder, const Files& files);

std::string read_text(const std::filesystem::path& file);

}  // namespace mebots::new_folder
