// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace mebots::master {

/// Units of the variables of a config's FMUs, by "instance.variable". A variable without a unit is left out. Throws
/// InputError.
std::map<std::string, std::string> variable_units(const std::filesystem::path& config);

}  // namespace mebots::master
