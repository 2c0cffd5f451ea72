// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

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

/// Words of a template and what stands for them, in names of files and in texts.
using Words = std::vector<std::pair<std::string, std::string>>;

/// The files of a template: path inside it, and text.
using Files = std::vector<std::pair<std::filesystem::path, std::string>>;

/// Reads templates/`name`, words replaced, by path.
Files read_template(const std::string& name, const Words& words);

/// Throws Error unless `name` can name a C function, a device and a CMake target: lower-case letters, digits and _,
/// and none of the words that the templates use themselves.
void require_name(const std::string& name);

/// Writes the files into a new folder. Throws Error when it exists.
void write_folder(const std::filesystem::path& folder, const Files& files);

std::string read_text(const std::filesystem::path& file);

}  // namespace mebots::new_folder
