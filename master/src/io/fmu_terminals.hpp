// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/terminals.hpp"

#include <filesystem>
#include <vector>

namespace mebots::master {

/// Reads the terminals of an FMU without unpacking it. Returns an empty list if the FMU declares none. Throws
/// mebots::Error if the file is not an FMU.
std::vector<modeldesc::DeclaredTerminal> read_fmu_terminals(const std::filesystem::path& archive);

}  // namespace mebots::master
