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
/// sections of a config, such as steps, stop conditions and recorded variables. MEbots stores these sections as JSON in
/// an annotation.
namespace mebots::master {

/// The type of the annotation that MEbots adds to the root system of an SSP.
inline constexpr std::string_view kSspAnnotation = "org.mebots.config";

/// The content of an SSP, converted to the JSON of a config. Nested systems are flattened: the instance `motor` of the
/// system `left` becomes `left.motor`.
struct SspConfig {
  nlohmann::ordered_json config;              ///< contains `step` and `stop_time` only if the SSP defines them
  std::map<std::string, std::string> places;  ///< maps JSON pointers to "SystemStructure.ssd, line 12"
  std::vector<std::string> notices;           ///< describe what was left out
  std::string source;                         ///< the bytes of all files that were read, for the hash of the inputs
};

/// States to which files URIs in an SSP may refer. The URIs of an archive must stay inside, because archives are not
/// trusted.
enum class SspReach { inside, anywhere };

/// Reads the file `ssd` of an SSP that is unpacked in `folder`. `archive` is the name of the SSP in messages. Paths of
/// FMUs in the result are absolute. Throws InputError with archive, file, line and element if there is a mistake.
SspConfig read_ssp(const std::filesystem::path& folder, const std::filesystem::path& archive, SspReach reach,
                   const std::string& ssd = "SystemStructure.ssd");

/// Writes a system as an SSP that contains all of its FMUs in resources/. `config` is the JSON of the system. Equal
/// systems result in equal bytes. Throws Error if the archive cannot be written.
void write_ssp(const ResolvedSystem& system, const nlohmann::ordered_json& config,
               const std::filesystem::path& archive);

/// Writes a system as a config. Copies its FMUs into the folder `<name>_fmus` next to the config. Throws Error if a
/// folder or file cannot be written.
void write_config(const SystemDescription& system, nlohmann::ordered_json config, const std::filesystem::path& file);

}  // namespace mebots::master

namespace mebots::master::ssp {

/// Reads an SSP as read_ssp() does, but from `files`, which may be in an archive or a folder. `archive` is the name of
/// the SSP in messages. Throws InputError if there is a mistake.
SspConfig read(const Files& files, const std::string& archive, const std::string& ssd = "SystemStructure.ssd");

}  // namespace mebots::master::ssp
