// SPDX-License-Identifier: Apache-2.0
// A config is a list of sections; each has its reader in config/. A new section is a line in the table below,
// a reader in a file of its own, and a property in configs/mebots-config.schema.json.
#include "config/sections.hpp"

#include <fmt/format.h>

#include <fstream>
#include <sstream>

namespace mebots::master {
namespace {

struct Section {
  std::string_view key;
  bool required;
  void (*read)(const JsonNode&, SystemDescription&);
};

// In the order of reading, which is not that of the file: a reader may count on those before it.
constexpr Section kSections[] = {
    {"text", false, &config::read_text},
    {"step", true, &config::read_step},
    {"instances", true, &config::read_instances},
    {"stop_time", true, &config::read_stop_time},
    {"connections", true, &config::read_connections},
    {"scenario", false, &config::read_scenario},
    {"stop_when", false, &config::read_stop_when},
    {"outcomes", false, &config::read_outcomes},
    {"summary", false, &config::read_summary},
    {"record", false, &config::read_record},
    {"pictures", false, &config::read_pictures},
    {"log", false, &config::read_log},
    {"threads", false, &config::read_threads},
};

std::string read_bytes(const std::filesystem::path& file) {
  if (std::filesystem::is_directory(file)) {
    throw InputError(fmt::format("{}: this is a folder; name a config file", file.string()));
  }
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError(fmt::format("{}: this config cannot be opened; does the file exist?", file.string()));
  std::ostringstream bytes;
  bytes << stream.rdbuf();
  if (stream.bad()) throw InputError(fmt::format("{}: this config cannot be read", file.string()));
  return bytes.str();
}

}  // namespace

SystemDescription read_config(const std::filesystem::path& file) {
  SystemDescription system;
  system.source = read_bytes(file);
  system.file = std::filesystem::absolute(file);
  system.name = file.stem().string();

  const auto json = parse_json(system.source, file.string());
  const JsonNode root(json, file.string());
  std::vector<std::string_view> keys;
  for (const auto& section : kSections) keys.push_back(section.key);
  root.expect_keys(keys);
  for (const auto& section : kSections) {
    if (section.required) static_cast<void>(root.at(section.key));  // what is missing is told before what is wrong
  }
  for (const auto& section : kSections) {
    if (section.required || root.has(section.key)) section.read(root.at(section.key), system);
  }
  return system;
}

}  // namespace mebots::master
