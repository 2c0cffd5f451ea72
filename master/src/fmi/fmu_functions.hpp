// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/fmi1/library.hpp"
#include "mebots/fmi2/library.hpp"
#include "mebots/fmi3/library.hpp"
#include "mebots/modeldesc/model_description.hpp"
#include "model/fmu_kind.hpp"

#include <filesystem>
#include <variant>

namespace mebots::master {

using Fmi1Functions = fmi1::Functions;
using Fmi2Functions = fmi2::Functions;
using Fmi3Functions = fmi3::Functions;

/// Contains the functions of an FMU's shared library in the table for its version of FMI.
using FmuFunctions = std::variant<std::monostate, Fmi1Functions, Fmi2Functions, Fmi3Functions>;

/// Identifies the FMU to which a library belongs.
struct LibraryOwner {
  const std::filesystem::path& archive;
  const modeldesc::ModelDescription& description;
  FmuKind kind;  ///< kind of the FMU's instances
};

/// Checks the functions of a library. Throws InputError with a list of the missing functions if the kind of simulation
/// needs them. (`mebots check` requires all functions of the standard.) Also throws InputError if the library is for
/// another version of FMI, or if its number types have other sizes than those of mebots.
void check_functions(const FmuFunctions& functions, const LibraryOwner& owner);

/// Looks up the functions in a library that dlopen() returned. Throws the same errors as check_functions().
FmuFunctions load_functions(void* library, const LibraryOwner& owner);

}  // namespace mebots::master
