// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/terminals.hpp"

#include <filesystem>
#include <vector>

namespace mebots::master {

/// Returns the terminals that an FMU declares, without unpacking the FMU. The list is empty if the FMU declares none.
/// Throws mebots::Error if the file is not an FMU.
std::vector<modeldesc::DeclaredTerminal> read_fmu_terminals(const std::filesystem::path& archive);

}  // namespace mebots::master
