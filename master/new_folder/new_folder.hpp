// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

/// Creates folders from the templates of the build or installation. Each folder builds and runs unchanged with an
/// installed MEbots. All functions throw Error if a name is invalid or the folder exists.
namespace mebots::new_folder {

enum class Language : std::uint8_t { c, rust };

/// Writes a bare-metal program for the chip: main.c or main.rs, CMakeLists.txt and README.md. If `folder` is empty,
/// writes into the subfolder `name` of the working folder. Returns the folder.
std::filesystem::path new_firmware(const std::string& name, Language language, std::filesystem::path folder);

struct Sensor {
  std::string name;
  /// The variable that the sensor measures: a Real output of the instance world, motors or battery of the mission.
  std::string senses = "world.range.down";
  /// The board that receives the sensor. If empty, uses GAP8 without other devices.
  std::filesystem::path board;
  /// True for a device with a C++ model in addition to the states in the board file.
  bool with_code = false;
};

/// Writes a folder with a new device, its driver, firmware, chip FMU and mission. Returns the folder.
std::filesystem::path new_sensor(const Sensor& sensor, std::filesystem::path folder);

/// Pairs of a word in a template and its replacement in file names and texts.
using Words = std::vector<std::pair<std::string, std::string>>;

/// Files of a template, as pairs of relative path and content.
using Files = std::vector<std::pair<std::filesystem::path, std::string>>;

/// Reads templates/`name` and replaces its words. Returns the files sorted by path.
Files read_template(const std::string& name, const Words& words);

/// Throws Error unless `name` is valid for a C function, a device and a CMake target: lower-case letters, digits and _,
/// starting with a letter, and not reserved by C or the templates.
void require_name(const std::string& name);

/// Writes the files into a new folder. Throws Error if the folder exists.
void write_folder(const std::filesystem::path& folder, const Files& files);

std::string read_text(const std::filesystem::path& file);

}  // namespace mebots::new_folder
