// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/resolved_system.hpp"

#include <pugixml.hpp>

namespace mebots::master::ssp {

/// Version of the files that are written.
inline constexpr const char* kWrittenVersion = "1.0";

/// Fills an SSV file with the start values of an instance, with the units of its FMU.
void write_parameter_set(const ResolvedInstance& instance, pugi::xml_document& document);

}  // namespace mebots::master::ssp
