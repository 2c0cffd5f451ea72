// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/system_description.hpp"

#include <filesystem>
#include <string>

namespace mebots::master {

/// Appends the overrides of a scenario file. Returns what to note among the changes: its name and hash. Throws
/// InputError.
std::string apply_scenario(SystemDescription& system, const std::filesystem::path& file);

}  // namespace mebots::master
