// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace mebots::master {

/// Maps the variables of a config's FMUs, as "instance.variable", to their units. Leaves out variables that have no
/// unit. Throws InputError if the config or an FMU cannot be read.
std::map<std::string, std::string> variable_units(const std::filesystem::path& config);

}  // namespace mebots::master
