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

using FmuFunctions = std::variant<std::monostate, Fmi1Functions, Fmi2Functions, Fmi3Functions>;

struct LibraryOwner {
  const std::filesystem::path& archive;
  const modeldesc::ModelDescription& description;
  FmuKind kind;
};

/// Checks the functions of a library. Throws InputError with a list of the missing functions that the kind of
/// simulation needs. Also throws InputError if the library is for another version of FMI, or if its number types have
/// other sizes.
void check_functions(const FmuFunctions& functions, const LibraryOwner& owner);

/// Finds the functions of a library from dlopen(). Throws like check_functions().
FmuFunctions load_functions(void* library, const LibraryOwner& owner);

}  // namespace mebots::master
