// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "io/ssp/ssp.hpp"
#include "model/system_description.hpp"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <optional>
#include <string>

/// From files to a SystemDescription.
namespace mebots::master {

/// Times that are given instead of those in the file, or because it has none [s].
struct GivenTimes {
  std::optional<WrittenTime> step;
  std::optional<double> stop_time_s;
};

/// A system together with the JSON that it was read from, or that stands for its SSP.
struct LoadedSystem {
  SystemDescription system;
  nlohmann::ordered_json config;
};

/// Reads a system from a config file, an FMU alone (`.fmu`), an SSP (`.ssp`, `.ssd`, or the folder of one) or an
/// OspSystemStructure.xml. Throws InputError that names file, line and column, JSON pointer and the nearest valid key.
LoadedSystem load_system(const std::filesystem::path& path, const GivenTimes& times = {});
/// The same without the JSON, which takes time of its own.
SystemDescription read_config(const std::filesystem::path& path, const GivenTimes& times = {});

/// load_system() for what is in memory already. `file` names it in messages; paths of FMUs are relative to it.
namespace config {

/// Reads a config file without opening its FMUs. Throws data::Mistakes with everything that is wrong in it.
void check(const std::filesystem::path& file);
/// The same of a scenario file, whose instances are not known.
void check_scenario(const std::filesystem::path& file);

LoadedSystem load_text(std::string text, const std::filesystem::path& file);
LoadedSystem load_ssp_config(SspConfig ssp, const std::filesystem::path& file, const GivenTimes& times);

/// Makes the paths of files of signals absolute in the JSON that `system` was read from, so that it can be read from
/// another folder.
void make_signal_paths_absolute(nlohmann::ordered_json& config, const SystemDescription& system);

}  // namespace config
}  // namespace mebots::master
