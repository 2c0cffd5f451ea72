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

/// Times [s] that replace the times of the file or supply missing times.
struct GivenTimes {
  std::optional<WrittenTime> step;
  std::optional<double> stop_time_s;
};

/// A system with the JSON that it was read from. For an SSP, `config` is the equivalent JSON.
struct LoadedSystem {
  SystemDescription system;
  nlohmann::ordered_json config;
};

/// Reads a system from a config file, an FMU alone (`.fmu`), an SSP (`.ssp`, `.ssd`, or the folder of one) or an
/// OspSystemStructure.xml. Throws InputError with file, line, column, JSON pointer and the nearest valid key.
LoadedSystem load_system(const std::filesystem::path& path, const GivenTimes& times = {});
/// Loads like load_system(), but does not return the JSON, which is faster.
SystemDescription read_config(const std::filesystem::path& path, const GivenTimes& times = {});

/// Loads like load_system() from a text in memory. `file` is the text's name in messages; paths of FMUs are relative to
/// `file`.
namespace config {

/// Reads a config file without opening its FMUs. Throws data::Mistakes with all errors.
void check(const std::filesystem::path& file);
/// Reads a scenario file without a config, so the instances of its variables are not checked. Throws data::Mistakes
/// with all errors.
void check_scenario(const std::filesystem::path& file);

LoadedSystem load_text(std::string text, const std::filesystem::path& file);
LoadedSystem load_ssp_config(SspConfig ssp, const std::filesystem::path& file, const GivenTimes& times);

/// Makes the paths of signal files absolute in the JSON from which `system` was read, so that the JSON can be read from
/// another folder.
void make_signal_paths_absolute(nlohmann::ordered_json& config, const SystemDescription& system);

}  // namespace config

/// The forms of a system's description.
enum class SystemForm {
  config,  ///< JSON
  fmu,     ///< an FMU alone, `.fmu`: the system of this one instance
  ssp,     ///< an SSP archive, `.ssp`
  ssd,     ///< an unpacked SSP, by its `.ssd`
  osp,     ///< OspSystemStructure.xml
};

/// The file that describes a system, and its form.
struct SystemFile {
  std::filesystem::path path;
  SystemForm form;
};

/// Determines the form from the file's extension. In a folder, looks for SystemStructure.ssd and
/// OspSystemStructure.xml. Throws InputError for a folder without either file.
SystemFile find_system(const std::filesystem::path& path);

/// True if the path's name indicates a file or folder that find_system() accepts; false for an FMU.
bool may_be_system(const std::filesystem::path& path);

/// Returns the system's name: the name of its file without extension. If the file of an unpacked SSP or of an OSP
/// system has the standard name, returns the name of the folder.
std::string system_name(const std::filesystem::path& path);

}  // namespace mebots::master

namespace mebots::master::config {

/// Returns the config of a run of a single FMU with one instance, named after the file. Times come from `times`, else
/// from the FMU's DefaultExperiment. By default, a run starts at 0 s and has 500 steps in 1 s. Rounds a stop time of
/// the DefaultExperiment down to a whole number of steps. The run records the FMU's outputs. If there are none, it
/// records the local variables. Appends notices with the chosen values and their origins. Throws InputError.
nlohmann::ordered_json single_fmu_config(const std::filesystem::path& fmu,
                                         const modeldesc::ModelDescription& description, const GivenTimes& times,
                                         std::vector<std::string>& notices);

}  // namespace mebots::master::config

namespace mebots::master {

/// Appends the overrides of a scenario file. Returns the file's name and hash for the list of changes. Throws
/// InputError.
std::string apply_scenario(SystemDescription& system, const std::filesystem::path& file);

}  // namespace mebots::master

/// A config that changes another config: `{"extends": "gate_hard.json", "changes": {...}}`. JSON merge patch (RFC 7396)
/// applies: objects are merged member by member, null removes a member, everything else is replaced.
namespace mebots::master::config {

inline constexpr const char* kExtends = "extends";
inline constexpr const char* kChanges = "changes";

/// Returns the name of the file that the variant extends, which must be in the same folder. Reports errors in the keys
/// `extends` and `changes`.
std::string read_variant(const data::Node& root);

/// Returns the merged config. The variant's `text` replaces the base's `text`.
nlohmann::ordered_json merged(nlohmann::ordered_json base, const nlohmann::ordered_json& variant);

/// Returns the file from which each part of the merged config comes, for data::Document. `base` is the content of the
/// extended file.
std::map<std::string, std::string> places_of(const nlohmann::ordered_json& variant, const nlohmann::ordered_json& base);

}  // namespace mebots::master::config

namespace mebots::master {

/// The JSON schema (draft 2020-12) of a kind of file, identical to configs/schemas/mebots-<kind>.schema.json.
struct Schema {
  std::string_view kind;  // "config"
  std::string_view text;
};

/// Returns the schemas of all kinds of file, sorted by name. Valid as long as the program.
std::span<const Schema> schemas();

/// These functions return the keys that a config may have, and the keys that an instance in a config may have.
std::vector<std::string> config_keys();
std::vector<std::string> instance_keys();

}  // namespace mebots::master
