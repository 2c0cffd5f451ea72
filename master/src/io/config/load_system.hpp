// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "io/ssp/ssp.hpp"
#include "mebots/data/node.hpp"
#include "mebots/modeldesc/model_description.hpp"
#include "model/system_description.hpp"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Reads a SystemDescription from files.
namespace mebots::master {

/// Times [s] that replace those in the file or supply missing ones.
struct GivenTimes {
  std::optional<WrittenTime> step;
  std::optional<double> stop_time_s;
};

/// A system and the JSON from which it was read. For an SSP, `config` is the equivalent JSON.
struct LoadedSystem {
  SystemDescription system;
  nlohmann::ordered_json config;
};

/// Reads a system. `path` is a config file, a single FMU (`.fmu`), an SSP (`.ssp`, `.ssd`, or a folder that contains
/// one) or an OspSystemStructure.xml. If there is a mistake, throws InputError with file, line, column, JSON pointer
/// and the nearest valid key.
LoadedSystem load_system(const std::filesystem::path& path, const GivenTimes& times = {});
/// Reads a system as load_system() does, but does not return the JSON, which is faster.
SystemDescription read_config(const std::filesystem::path& path, const GivenTimes& times = {});

namespace config {

/// Checks a config file without opening its FMUs. Throws data::Mistakes with all mistakes.
void check(const std::filesystem::path& file);
/// Checks a scenario file without its config. Therefore, the instances of its variables are not checked. Throws
/// data::Mistakes with all mistakes.
void check_scenario(const std::filesystem::path& file);

/// Reads a system from a text in memory. `file` names the text in messages; paths of FMUs are relative to it.
LoadedSystem load_text(std::string text, const std::filesystem::path& file);
LoadedSystem load_ssp_config(SspConfig ssp, const std::filesystem::path& file, const GivenTimes& times);

/// Makes the paths of signal files in `config` absolute, so that the JSON can be used in another folder. `system` must
/// have been read from `config`.
void make_signal_paths_absolute(nlohmann::ordered_json& config, const SystemDescription& system);

}  // namespace config

/// The kinds of files that describe a system.
enum class SystemForm {
  config,  ///< JSON
  fmu,     ///< a single FMU, `.fmu`: the system consists of this instance
  ssp,     ///< an SSP archive, `.ssp`
  ssd,     ///< an unpacked SSP, given by its `.ssd`
  osp,     ///< OspSystemStructure.xml
};

/// The path of a file that describes a system, and the kind of this file.
struct SystemFile {
  std::filesystem::path path;
  SystemForm form;
};

/// Determines the kind of the file from its extension. If `path` is a folder, looks for SystemStructure.ssd and
/// OspSystemStructure.xml. Throws InputError if the folder contains neither.
SystemFile find_system(const std::filesystem::path& path);

/// True if the name of the path is that of a file or folder that find_system() accepts. False for an FMU.
bool may_be_system(const std::filesystem::path& path);

/// Returns the name of the system: the file's name without extension. If the file of an unpacked SSP or of an OSP
/// system has the standard name, returns the name of the folder.
std::string system_name(const std::filesystem::path& path);

}  // namespace mebots::master

namespace mebots::master::config {

/// Returns a config that runs a single FMU with one instance, named after the file. Times come from `times`, otherwise
/// from the FMU's DefaultExperiment. Without both, the run starts at 0 s and takes 500 steps in 1 s. Rounds a stop time
/// of the DefaultExperiment down to a whole number of steps. The run records the FMU's outputs; if it has none, the
/// local variables. Appends notices that state the chosen values and their origins. Throws InputError.
nlohmann::ordered_json single_fmu_config(const std::filesystem::path& fmu,
                                         const modeldesc::ModelDescription& description, const GivenTimes& times,
                                         std::vector<std::string>& notices);

}  // namespace mebots::master::config

namespace mebots::master {

/// Reads a scenario file and appends its overrides to the system. Returns the name and hash of the file for the list of
/// changes. Throws InputError.
std::string apply_scenario(SystemDescription& system, const std::filesystem::path& file);

}  // namespace mebots::master

/// Reads a config that changes another config: `{"extends": "gate_hard.json", "changes": {...}}`. The changes are
/// applied as a JSON merge patch (RFC 7396): objects are merged member by member, null removes a member, and everything
/// else is replaced.
namespace mebots::master::config {

inline constexpr const char* kExtends = "extends";
inline constexpr const char* kChanges = "changes";

/// Returns the name of the file that the variant extends; it must be in the same folder. Reports mistakes in the keys
/// `extends` and `changes`.
std::string read_variant(const data::Node& root);

/// Applies the changes to `base` and returns the merged config. The variant's `text` replaces that of the base.
nlohmann::ordered_json merged(nlohmann::ordered_json base, const nlohmann::ordered_json& variant);

/// Maps parts of the merged config to their places for data::Document: the key `changes`, or otherwise `extends` with
/// the name of the extended file. `base` is the content of the extended file.
std::map<std::string, std::string> places_of(const nlohmann::ordered_json& variant, const nlohmann::ordered_json& base);

}  // namespace mebots::master::config

namespace mebots::master {

/// The JSON schema (draft 2020-12) of one kind of file. Identical to configs/schemas/mebots-<kind>.schema.json.
struct Schema {
  std::string_view kind;  // kind of file, such as "config"
  std::string_view text;
};

/// Returns the schemas of all kinds of files, sorted by name. They are valid until the program ends.
std::span<const Schema> schemas();

/// These functions return the permitted keys of a config, and of an instance in a config.
std::vector<std::string> config_keys();
std::vector<std::string> instance_keys();

}  // namespace mebots::master
