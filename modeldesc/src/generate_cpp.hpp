// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "description.hpp"

#include <string>

/// The three C++ files that the build makes of a description.
namespace mebots::modeldesc {

/// variables.hpp: Parameters, Inputs, Outputs, Variables; knows nothing of FMI.
std::string variables_header(const Description& description);

/// binding.hpp: declares the make_model() that fmu.cpp defines.
std::string binding_header(const Description& description);

/// variable_table.cpp: defines the mebots::fmu::Definition that the shell serves.
std::string variable_table_source(const Description& description, const std::string& guid);

}  // namespace mebots::modeldesc
