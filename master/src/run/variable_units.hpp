// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace mebots::master {

/// Returns the units of all variables of a config's FMUs by "instance.variable". Omits variables without a unit. Throws
/// InputError if the config or an FMU cannot be read.
std::map<std::string, std::string> variable_units(const std::filesystem::path& config);

}  // namespace mebots::master
