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

namespace mebots::master {

/// Times that replace or complete those of the file.
struct GivenTimes {
  std::optional<WrittenTime> step;
  std::optional<double> stop_time_s;
};

/// A system and its JSON. For an SSP, `config` is the equivalent JSON.
struct LoadedSystem {
  SystemDescription system;
  nlohmann::ordered_json config;
};

/// Reads a system. `path` is a config file, an FMU (`.fmu`), an SSP (`.ssp`, `.ssd`, or a folder with an `.ssd`) or an
/// OspSystemStructure.xml. Throws InputError with the file, line, column and JSON pointer of a mistake, and the nearest
/// valid key.
LoadedSystem load_system(const std::filesystem::path& path, const GivenTimes& times = {});
/// Reads a system without returning its JSON, which is faster than load_system().
SystemDescription read_config(const std::filesystem::path& path, const GivenTimes& times = {});

namespace config {

/// Checks a config file without opening its FMUs. Throws data::Mistakes with all mistakes.
void check(const std::filesystem::path& file);
/// Checks a scenario file. Does not check whether its variables exist, because no config is given. Throws
/// data::Mistakes with all mistakes.
void check_scenario(const std::filesystem::path& file);

/// Reads a system from `text`. Messages name `file`. Paths of FMUs are relative to its folder.
LoadedSystem load_text(std::string text, const std::filesystem::path& file);
LoadedSystem load_ssp_config(SspConfig ssp, const std::filesystem::path& file, const GivenTimes& times);

/// Makes the paths of signal files in `config` absolute, so that it can be written to another folder. `system` must
/// have been read from `config`.
void make_signal_paths_absolute(nlohmann::ordered_json& config, const SystemDescription& system);

}  // namespace config

enum class SystemForm {
  config,  ///< JSON
  fmu,     ///< a single FMU, `.fmu`
  ssp,     ///< an SSP archive, `.ssp`
  ssd,     ///< the `.ssd` of an unpacked SSP
  osp,     ///< OspSystemStructure.xml
};

struct SystemFile {
  std::filesystem::path path;
  SystemForm form;
};

/// Determines the kind of a file from its extension. Searches a folder for SystemStructure.ssd and
/// OspSystemStructure.xml. Throws InputError if the folder contains neither.
SystemFile find_system(const std::filesystem::path& path);

/// True if find_system() may accept the path because of its name. False for an FMU.
bool may_be_system(const std::filesystem::path& path);

/// Returns the name of the system: the name of the file without extension or, if an SSD or OSP file has the standard
/// name, the name of its folder.
std::string system_name(const std::filesystem::path& path);

}  // namespace mebots::master

namespace mebots::master::config {

/// Returns a config for a single FMU. The instance has the name of the file. Times come from `times` or, if absent,
/// from the DefaultExperiment of the FMU. If that is absent, too, the run starts at 0 s and takes 500 steps in 1 s.
/// Rounds the stop time of a DefaultExperiment down to a whole number of steps. The run records the outputs or, if the
/// FMU has none, the local variables. Adds notices about the chosen values. Throws InputError.
nlohmann::ordered_json single_fmu_config(const std::filesystem::path& fmu,
                                         const modeldesc::ModelDescription& description, const GivenTimes& times,
                                         std::vector<std::string>& notices);

}  // namespace mebots::master::config

namespace mebots::master {

/// Appends the overrides of a scenario file to the system. Returns the name and hash of the file for the list of
/// changes. Throws InputError.
std::string apply_scenario(SystemDescription& system, const std::filesystem::path& file);

}  // namespace mebots::master

/// Reads a config that changes another config: `{"extends": "gate_hard.json", "changes": {...}}`. The changes are a
/// JSON merge patch (RFC 7396): objects are merged, null removes a member, and all other values are replaced.
namespace mebots::master::config {

inline constexpr const char* kExtends = "extends";
inline constexpr const char* kChanges = "changes";

/// Returns the name of the extended file, which must be in the same folder. Reports mistakes in `extends` and
/// `changes`.
std::string read_variant(const data::Node& root);

/// Returns `base` with the changes of the variant. If the variant has a `text`, it replaces the `text` of the base.
nlohmann::ordered_json merged(nlohmann::ordered_json base, const nlohmann::ordered_json& variant);

/// Returns where the parts of the merged config are written, for error messages of data::Document. The keys are JSON
/// pointers. The place of a changed part is "changes", the place of all other parts is "extends FILE". `base` is the
/// content of the extended file.
std::map<std::string, std::string> places_of(const nlohmann::ordered_json& variant, const nlohmann::ordered_json& base);

}  // namespace mebots::master::config

namespace mebots::master {

/// The JSON schema (draft 2020-12) for one kind of file. It is equal to configs/schemas/mebots-<kind>.schema.json.
struct Schema {
  std::string_view kind;  // kind of file, such as "config"
  std::string_view text;
};

/// Returns the schemas of all kinds of files, sorted by name. They are valid until the program ends.
std::span<const Schema> schemas();

/// Returns the valid keys of a config, or of an instance in a config.
std::vector<std::string> config_keys();
std::vector<std::string> instance_keys();

}  // namespace mebots::master
