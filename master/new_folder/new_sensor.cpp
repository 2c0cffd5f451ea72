// SPDX-License-Identifier: Apache-2.0
#include "new_folder.hpp"

#include "base/installation.hpp"
#include "fmi/fmu.hpp"
#include "io/find_fmu.hpp"
#include "mebots/error.hpp"
#include "mebots/nearest_names.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <set>

namespace mebots::new_folder {
namespace {

namespace fs = std::filesystem;

/// The instances of the template's mission that a sensor can measure, with their FMUs.
constexpr std::array<std::pair<std::string_view, std::string_view>, 3> kSensed = {
    {{"world", "fmu_world"}, {"motors", "fmu_motors"}, {"battery", "fmu_battery"}}};

/// Returns the unit of a variable such as "world.range.down" from the FMU's description.
std::string unit_of(const std::string& text) {
  const auto dot = text.find('.');
  const auto instance = text.substr(0, dot);
  const auto* const known = std::ranges::find(kSensed, instance, [](const auto& entry) { return entry.first; });
  if (dot == std::string::npos || known == kSensed.end()) {
    std::vector<std::string> names;
    names.reserve(kSensed.size());
    for (const auto& [name, fmu] : kSensed) names.emplace_back(name);
    throw Error(ErrorCode::unknown_name,
                fmt::format("--senses '{}': write INSTANCE.VARIABLE of the mission's instances. {}", text,
                            suggest(instance, names)));
  }
  const auto name = text.substr(dot + 1);
  const auto archive = master::find_fmu(known->second, ".");
  const auto fmu = master::FmuLibrary().open(archive);
  std::vector<std::string> outputs;
  for (const auto& variable : fmu->description().variables) {
    if (variable.causality != modeldesc::Causality::output || variable.type != modeldesc::Type::real) continue;
    if (variable.name == name) return variable.unit.empty() ? "1" : variable.unit;
    outputs.push_back(variable.name);
  }
  throw Error(ErrorCode::unknown_name, fmt::format("--senses '{}': {} has no Real output '{}'. {}", text, known->second,
                                                   name, suggest(name, outputs)));
}

/// A free address and interrupt for a new device.
struct Slot {
  std::uint32_t base = 0;
  int interrupt = 0;
};

std::uint32_t address(const std::string& text) {
  std::uint32_t value = 0;
  const auto digits = std::string_view(text).substr(text.starts_with("0x") ? 2 : 0);
  std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
  return value;
}

/// Returns the first free page above the devices of GAP8, and the first free interrupt. Ignores other errors of the
/// board, which the build reports.
Slot free_slot(const std::string& text, const fs::path& board, const std::string& name) {
  constexpr std::uint32_t kFirstBase = 0x1A188000;
  constexpr std::uint32_t kPage = 0x1000;
  constexpr int kFirstInterrupt = 16;
  constexpr int kLastInterrupt = 31;
  std::set<std::uint32_t> pages;
  std::set<int> interrupts;
  try {
    const auto board_json = nlohmann::json::parse(text);
    for (const auto& device : board_json.at("devices")) {
      if (device.at("name") == name) {
        throw Error(ErrorCode::duplicate_name,
                    fmt::format("{}: there is already a device '{}'; choose another name", board.string(), name));
      }
      pages.insert(address(device.at("base").get<std::string>()) / kPage);
      interrupts.insert(device.value("interrupt", -1));
    }
  } catch (const nlohmann::json::exception& error) {
    throw Error(ErrorCode::syntax_error,
                fmt::format("{}: this is not a board file ({})", board.string(), error.what()));
  }
  Slot slot{kFirstBase, kFirstInterrupt};
  while (pages.contains(slot.base / kPage)) slot.base += kPage;
  while (interrupts.contains(slot.interrupt)) ++slot.interrupt;
  if (slot.interrupt > kLastInterrupt) {
    throw Error(ErrorCode::invalid_value, fmt::format("{}: all interrupts of the board are in use", board.string()));
  }
  return slot;
}

/// Appends an entry to the list "devices". Preserves the rest of the text.
std::string with_device(const std::string& board, const std::string& entry) {
  auto at = board.find('[', board.find("\"devices\""));
  int depth = 0;
  bool quoted = false;
  for (; at < board.size(); ++at) {
    const char c = board[at];
    if (c == '\\') {
      ++at;
    } else if (c == '"') {
      quoted = !quoted;
    } else if (!quoted && c == '[') {
      ++depth;
    } else if (!quoted && c == ']' && --depth == 0) {
      break;
    }
  }
  const auto last = board.find_last_of('}', at);
  return board.substr(0, last + 1) + ",\n" + entry + "  " + board.substr(at);
}

std::string library_call(const std::string& name) {
  return fmt::format("mebots_device_library({0} SOURCES {0}.cpp)\n", name);
}

/// Adds the device's library to the list "libraries". Creates the list if it is missing.
std::string with_library(const std::string& board, const std::string& name) {
  constexpr std::string_view kList = "\"libraries\": [";
  if (const auto list = board.find(kList); list != std::string::npos) {
    return board.substr(0, list + kList.size()) + fmt::format("\"{}.so\", ", name) + board.substr(list + kList.size());
  }
  const auto devices = board.find("\"devices\"");
  return board.substr(0, devices) + fmt::format("\"libraries\": [\"{}.so\"],\n  ", name) + board.substr(devices);
}

std::string taken(Files& files, const fs::path& name) {
  const auto file = std::ranges::find(files, name, [](const auto& entry) { return entry.first; });
  auto text = std::move(file->second);
  files.erase(file);
  return text;
}

}  // namespace

fs::path new_sensor(const Sensor& sensor, fs::path folder) {
  require_name(sensor.name);
  const auto unit = unit_of(sensor.senses);
  const auto board = sensor.board.empty() ? master::own_data("configs") / "boards/gap8_bare.json" : sensor.board;
  const auto board_text = read_text(board);
  const auto slot = free_slot(board_text, board, sensor.name);
  auto upper = sensor.name;
  std::ranges::transform(upper, upper.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  std::string camel;
  for (std::size_t i = 0; i < upper.size(); ++i) {
    if (upper[i] != '_') camel += i == 0 || upper[i - 1] == '_' ? upper[i] : sensor.name[i];
  }
  auto files = read_template("my_sensor",
                             {{"my_sensor", sensor.name},
                              {"MY_SENSOR", upper},
                              {"MySensor", camel},
                              {"SENSED_VARIABLE", sensor.senses},
                              {"SENSED_UNIT", unit},
                              {"DEVICE_BASE", fmt::format("0x{:08X}", slot.base)},
                              {"DEVICE_INTERRUPT", std::to_string(slot.interrupt)},
                              {"DEVICE_LIBRARY", sensor.with_code ? library_call(sensor.name) : ""},
                              {"DEVICES_OPTION", sensor.with_code ? " DEVICES " + sensor.name : ""},
                              {"ENTRY_KIND", sensor.with_code ? fmt::format("\"kind\": \"{}\", ", sensor.name) : ""},
                              {"INITIAL_STATE", sensor.with_code ? "" : "\"initial_state\": \"standby\","}});
  if (!sensor.with_code) taken(files, sensor.name + ".cpp");
  const auto entry = taken(files, "device.json");
  auto own_board = with_device(board_text, entry);
  if (sensor.with_code) own_board = with_library(own_board, sensor.name);
  files.emplace_back("board.json", std::move(own_board));
  if (folder.empty()) folder = sensor.name;
  write_folder(folder, files);
  return folder;
}

}  // namespace mebots::new_folder
