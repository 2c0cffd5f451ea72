// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "io/ssp/ssp.hpp"
#include "model/system_description.hpp"

/// load_system() for what is in memory already. `file` names it in messages; paths of FMUs are relative to it.
namespace mebots::master::config {

/// Reads a config file without opening its FMUs. Throws data::Mistakes with everything that is wrong in it.
void check(const std::filesystem::path& file);
/// The same of a scenario file, whose instances nobody knows.
void check_scenario(const std::filesystem::path& file);

LoadedSystem load_text(std::string text, const std::filesystem::path& file);
LoadedSystem load_ssp_config(SspConfig ssp, const std::filesystem::path& file, const GivenTimes& times);

/// Makes the paths of files of signals absolute in the JSON that `system` was read from, so that it can be read from
/// another folder.
void make_signal_paths_absolute(nlohmann::ordered_json& config, const SystemDescription& system);

}  // namespace mebots::master::config
