// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/master/ssp.hpp"
#include "mebots/master/system_description.hpp"

/// load_system() for what is in memory already. `file` names it in messages; paths of FMUs are relative to it.
namespace mebots::master::config {

LoadedSystem load_text(std::string text, const std::filesystem::path& file);
LoadedSystem load_ssp_config(SspConfig ssp, const std::filesystem::path& file, const GivenTimes& times);

}  // namespace mebots::master::config
