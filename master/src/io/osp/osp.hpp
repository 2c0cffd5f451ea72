// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "io/ssp/ssp.hpp"

#include <filesystem>

namespace mebots::master {

/// Reads an OspSystemStructure.xml of the Open Simulation Platform: simulators, initial values, steps, functions and
/// connections. Reads variable groups from <modelName>_OspModelDescription.xml in the folder of the system or of the
/// FMU. Also reads the modelDescription.xml of each FMU to determine which end of a connection is the output. Throws
/// InputError with file, line and element of a mistake.
SspConfig read_osp(const std::filesystem::path& file);

}  // namespace mebots::master
