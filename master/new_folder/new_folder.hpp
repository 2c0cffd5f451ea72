// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

/// Creates folders from templates. The templates are in templates/ of the build or installation. Each created folder
/// builds and runs unchanged with an installed MEbots. All functions throw Error if a name is invalid, or if the folder
/// exists, so that nothing is overwritten.
namespace mebots::new_folder {

enum class Language : std::uint8_t { c, rust };

/// Writes a bare-metal program for the chip: main.c or main.rs, CMakeLists.txt and README.md. If `folder` is empty,
/// writes into the subfolder `name` of the working folder. Returns the folder.
std::filesystem::path new_firmware(const std::string& name, Language language, std::filesystem::path folder);

struct Sensor {
  std::string name;
  /// The variable of the mission that the sensor measures. It must be a Real output of the instance world, motors or
  /// battery.
  std::string senses = "world.range.down";
  /// The board that receives the sensor. If the path is empty, the board is GAP8 without other devices.
  std::filesystem::path board;
  /// If true, implements the device by a C++ model, in addition to the states in the board file.
  bool with_code = false;
};

/// Writes a folder that contains a new device of a board with its driver, firmware, chip FMU and mission. Returns the
/// folder.
std::filesystem::path new_sensor(const Sensor& sensor, std::filesystem::path folder);

/// The words of a template and the words that replace them in file names and texts.
using Words = std::vector<std::pair<std::string, std::string>>;

/// The files of a template; each entry has a relative path and a text.
using Files = std::vector<std::pair<std::filesystem::path, std::string>>;

/// Reads the template in templates/`name` and replaces its words. Returns the files sorted by path.
Files read_template(const std::string& name, const Words& words);

/// Throws Error unless `name` can be the name of a C function, a device and a CMake target. Such a name consists of
/// lower-case letters, digits and _, starts with a letter, and is not in a list of words that C or the templates use.
void require_name(const std::string& name);

/// Writes the files into a new folder. Throws Error if the folder exists.
void write_folder(const std::filesystem::path& folder, const Files& files);

std::string read_text(const std::filesystem::path& file);

}  // namespace mebots::new_folder
