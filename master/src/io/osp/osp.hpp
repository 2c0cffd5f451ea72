// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "io/ssp/ssp.hpp"

#include <filesystem>

namespace mebots::master {

/// Reads an OspSystemStructure.xml of the Open Simulation Platform: simulators, initial values, steps, functions,
/// connections of variables and of variable groups (<modelName>_OspModelDescription.xml beside the system or the FMU).
/// The descriptions of the FMUs are read, since OSP leaves it to them which end of a connection is the output. Throws
/// InputError naming file, line and element.
SspConfig read_osp(const std::filesystem::path& file);

}  // namespace mebots::master
