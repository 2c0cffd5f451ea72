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

/// Reads and writes systems in SSP 1.0 and 2.0 (System Structure and Parameterization). SSP has no elements for some
/// sections of a config, such as steps, stop conditions and recorded variables. These sections are stored as JSON in an
/// annotation.
namespace mebots::master {

/// The type of MEbots' annotation in the root system of an SSP.
inline constexpr std::string_view kSspAnnotation = "org.mebots.config";

/// The content of an SSP as the JSON of a config. Nested systems are flattened: the instance `motor` of the system
/// `left` becomes `left.motor`.
struct SspConfig {
  nlohmann::ordered_json config;              ///< `step` and `stop_time` only if the SSP defines them
  std::map<std::string, std::string> places;  ///< maps JSON pointers to "SystemStructure.ssd, line 12"
  std::vector<std::string> notices;           ///< what was left out
  std::string source;                         ///< the bytes of all files read, for the hash of the inputs
};

/// The files that URIs in an SSP may name. Archives are not trusted, so their URIs must stay inside the SSP.
enum class SspReach { inside, anywhere };

/// Reads the SSP that is unpacked in `folder`, from its file `ssd`. `archive` is the SSP's name in messages. FMU paths
/// in the result are absolute. Throws InputError with archive, file, line and element.
SspConfig read_ssp(const std::filesystem::path& folder, const std::filesystem::path& archive, SspReach reach,
                   const std::string& ssd = "SystemStructure.ssd");

/// Writes a system as an SSP with all its FMUs in resources/. `config` is the JSON of the system. Equal systems give
/// equal bytes. Throws Error if the archive cannot be written.
void write_ssp(const ResolvedSystem& system, const nlohmann::ordered_json& config,
               const std::filesystem::path& archive);

/// Writes a system as a config, with its FMUs in the folder `<name>_fmus` next to it. Throws Error if a folder or file
/// cannot be written.
void write_config(const SystemDescription& system, nlohmann::ordered_json config, const std::filesystem::path& file);

}  // namespace mebots::master

namespace mebots::master::ssp {

/// Reads an SSP like read_ssp(), from `files`, which may be in an archive or a folder. `archive` is the name of the SSP
/// in messages. Throws InputError.
SspConfig read(const Files& files, const std::string& archive, const std::string& ssd = "SystemStructure.ssd");

}  // namespace mebots::master::ssp
