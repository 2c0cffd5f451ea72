// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "files.hpp"
#include "model/resolved_system.hpp"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

/// Reads and writes systems in SSP 1.0 and 2.0 (System Structure and Parameterization). Sections of a config without an
/// equivalent in SSP, such as stop conditions, are stored as JSON in an annotation.
namespace mebots::master {

/// The type of MEbots' annotation of the root system.
inline constexpr std::string_view kSspAnnotation = "org.mebots.config";

/// The config of an SSP. Nested systems are flattened: the instance `motor` of the system `left` becomes `left.motor`.
struct SspConfig {
  nlohmann::ordered_json config;              ///< contains `step` and `stop_time` only if the SSP defines them
  std::map<std::string, std::string> places;  ///< places of JSON pointers, such as "SystemStructure.ssd, line 12"
  std::vector<std::string> notices;           ///< notices about ignored parts of the SSP
  std::string source;                         ///< bytes of all files that were read, for the hash of the inputs
};

/// The files to which URIs in an SSP may refer. `inside` is for archives, which are not trusted.
enum class SspReach { inside, anywhere };

/// Reads the file `ssd` of an SSP that is unpacked in `folder`. Messages contain `archive`, the name of the SSP. Paths
/// of FMUs in the result are absolute. Throws InputError with archive, file, line and element of a mistake.
SspConfig read_ssp(const std::filesystem::path& folder, const std::filesystem::path& archive, SspReach reach,
                   const std::string& ssd = "SystemStructure.ssd");

/// Writes a system as an SSP with all FMUs in resources/. `config` is the JSON of the system. Equal systems result in
/// equal bytes. Throws Error if the archive cannot be written.
void write_ssp(const ResolvedSystem& system, const nlohmann::ordered_json& config,
               const std::filesystem::path& archive);

/// Writes a system as a config, and copies its FMUs into the folder `<name>_fmus` next to the config. Throws Error if a
/// folder or file cannot be written.
void write_config(const SystemDescription& system, nlohmann::ordered_json config, const std::filesystem::path& file);

}  // namespace mebots::master

namespace mebots::master::ssp {

/// Reads an SSP from `files`. Messages contain `archive`, the name of the SSP. Throws InputError if there is a mistake.
SspConfig read(const Files& files, const std::string& archive, const std::string& ssd = "SystemStructure.ssd");

}  // namespace mebots::master::ssp
