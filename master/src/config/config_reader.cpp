// SPDX-License-Identifier: Apache-2.0
// A config is a list of sections; each has its reader in config/. A new section is a line in the table below,
// a reader in a file of its own, and a property in configs/mebots-config.schema.json.
#include "config/config_schema.hpp"
#include "config/json_document.hpp"
#include "ssp/ssp.hpp"

#include "base/input_text.hpp"
#include "config/from_memory.hpp"
#include "config/sections.hpp"

#include <fmt/format.h>

namespace mebots::master {
namespace {

struct Section {
  std::string_view key;
  bool required;
  void (*read)(const JsonNode&, SystemDescription&);
};

// In the order of reading, which is not that of the file: a reader may count on those before it.
constexpr Section kSections[] = {
    {"$schema", false, &config::read_text},
    {"text", false, &config::read_text},
    {"step", true, &config::read_step},
    {"instances", true, &config::read_instances},
    {"stop_time", true, &config::read_stop_time},
    {"connections", true, &config::read_connections},
    {"algorithm", false, &config::read_algorithm},
    {"scenario", false, &config::read_scenario},
    {"stop_when", false, &config::read_stop_when},
    {"outcomes", false, &config::read_outcomes},
    {"summary", false, &config::read_summary},
    {"record", false, &config::read_record},
    {"pictures", false, &config::read_pictures},
    {"log", false, &config::read_log},
    {"threads", false, &config::read_threads},
};

void refuse_archive(std::string_view text, const std::filesystem::path& file) {
  if (!text.starts_with("PK\x03\x04")) return;
  throw InputError(fmt::format(
      "{}: this is an archive, and no config; of an FMU `mebots info` tells its variables, and an SSP has a "
      "name that ends in .ssp",
      file.string()));
}

nlohmann::ordered_json give(nlohmann::ordered_json config, const GivenTimes& times) {
  if (times.step_s) config["step"] = *times.step_s;
  if (times.stop_time_s) config["stop_time"] = *times.stop_time_s;
  return config;
}

SspConfig open_ssp(const std::filesystem::path& file, SystemDescription& system) {
  auto folder = std::make_shared<const modeldesc::TemporaryFolder>("mebots");
  system.unpacked = folder;
  try {
    modeldesc::unpack(file, folder->path());
    return read_ssp(folder->path(), file);
  } catch (const InputError&) {
    throw;
  } catch (const Error& error) {
    throw InputError(error.what());
  }
}

void read_sections(const JsonDocument& document, SystemDescription& system) {
  const auto root = document.root();
  std::vector<std::string_view> keys;
  for (const auto& section : kSections) keys.push_back(section.key);
  root.expect_keys(keys);
  for (const auto& section : kSections) {
    if (section.required) static_cast<void>(root.at(section.key));  // what is missing is told before what is wrong
  }
  for (const auto& section : kSections) {
    if (section.required || root.has(section.key)) section.read(root.at(section.key), system);
  }
}

void read_config_text(LoadedSystem& loaded, const std::string& file, const GivenTimes& times) {
  const JsonDocument document(loaded.system.source, file);
  loaded.config = document.value();
  if (times.step_s || times.stop_time_s) {
    loaded.config = give(std::move(loaded.config), times);
    read_sections(JsonDocument(loaded.config, file, {}), loaded.system);
  } else {
    read_sections(document, loaded.system);
  }
}

void read_ssp_config(LoadedSystem& loaded, SspConfig ssp, const std::string& file, const GivenTimes& times) {
  loaded.system.notices = std::move(ssp.notices);
  loaded.config = give(std::move(ssp.config), times);
  for (const auto* key : {"step", "stop_time"}) {
    if (loaded.config.contains(key)) continue;
    throw InputError(fmt::format("{}: the SSP does not say its {}; give it with --{}", file,
                                 key == std::string_view("step") ? "communication step" : "stop time",
                                 key == std::string_view("step") ? "step" : "stop-time"));
  }
  read_sections(JsonDocument(loaded.config, file, std::move(ssp.places)), loaded.system);
}

LoadedSystem named(std::string source, const std::filesystem::path& file) {
  LoadedSystem loaded;
  loaded.system.source = std::move(source);
  loaded.system.file = std::filesystem::absolute(file);
  loaded.system.name = file.stem().string();
  return loaded;
}

}  // namespace

std::vector<std::string> config_keys() {
  std::vector<std::string> keys;
  for (const auto& section : kSections) keys.emplace_back(section.key);
  return keys;
}

LoadedSystem config::load_text(std::string text, const std::filesystem::path& file) {
  auto loaded = named(std::move(text), file);
  read_config_text(loaded, file.string(), {});
  return loaded;
}

LoadedSystem config::load_ssp_config(SspConfig ssp, const std::filesystem::path& file, const GivenTimes& times) {
  auto loaded = named({}, file);
  read_ssp_config(loaded, std::move(ssp), file.string(), times);
  return loaded;
}

LoadedSystem load_system(const std::filesystem::path& file, const GivenTimes& times) {
  auto loaded = named(input_text(file), file);
  if (file.extension() == ".ssp") {
    read_ssp_config(loaded, open_ssp(file, loaded.system), file.string(), times);
  } else {
    refuse_archive(loaded.system.source, file);
    read_config_text(loaded, file.string(), times);
  }
  return loaded;
}

SystemDescription read_config(const std::filesystem::path& file) {
  return load_system(file).system;
}

}  // namespace mebots::master
