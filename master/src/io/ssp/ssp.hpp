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

/// SSP 1.0 and 2.0 (System Structure and Parameterization) as a second door to a system. What SSP cannot say (steps,
/// stop conditions, what to record ...) travels as an annotation that holds those sections of a config as JSON.
namespace mebots::master {

/// The type of our annotation at the root system.
inline constexpr std::string_view kSspAnnotation = "org.mebots.config";

/// What an SSP says, as the JSON of a config. Nested systems are flattened: the instance `motor` of the system
/// `left` is `left.motor`.
struct SspConfig {
  nlohmann::ordered_json config;              ///< `step` and `stop_time` only if the SSP gives them
  std::map<std::string, std::string> places;  ///< JSON pointer to "SystemStructure.ssd, line 12"
  std::vector<std::string> notices;           ///< what was left out
  std::string source;                         ///< the bytes of all files that were read, for the hash of the inputs
};

/// The files that the URIs of an SSP may name. An archive can come from anybody, so that its URIs stay inside.
enum class SspReach { inside, anywhere };

/// Reads the SSP unpacked in `folder`, from its file `ssd`; `archive` names it in messages. FMU paths in the result are
/// absolute. Throws InputError naming archive, file, line and element.
SspConfig read_ssp(const std::filesystem::path& folder, const std::filesystem::path& archive, SspReach reach,
                   const std::string& ssd = "SystemStructure.ssd");

/// Writes a system as an SSP with all its FMUs in resources/. `config` is the JSON that the system was read from.
/// Same system, same bytes. Throws Error when the archive cannot be written.
void write_ssp(const ResolvedSystem& system, const nlohmann::ordered_json& config,
               const std::filesystem::path& archive);

/// Writes a system as a config beside which its FMUs lie in the folder `<name>_fmus`. Throws Error for a folder or
/// file that cannot be written.
void write_config(const SystemDescription& system, nlohmann::ordered_json config, const std::filesystem::path& file);

}  // namespace mebots::master

namespace mebots::master::ssp {

/// read_ssp() wherever the files lie; `archive` names the SSP in messages. Throws InputError.
SspConfig read(const Files& files, const std::string& archive, const std::string& ssd = "SystemStructure.ssd");

}  // namespace mebots::master::ssp
