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

/// The functions of an FMU's shared library, in the table of its version of FMI.
using FmuFunctions = std::variant<std::monostate, Fmi1Functions, Fmi2Functions, Fmi3Functions>;

/// The FMU to which a library belongs.
struct LibraryOwner {
  const std::filesystem::path& archive;
  const modeldesc::ModelDescription& description;
  FmuKind kind;  ///< of its instances
};

/// Throws InputError with a list of the missing functions if the kind of simulation needs them. (`mebots check`
/// requires all functions of the standard.) Also throws if the library is for another version of FMI. Also throws if
/// the library's number types have other sizes than those of mebots.
void check_functions(const FmuFunctions& functions, const LibraryOwner& owner);

/// Looks up the functions in a library from dlopen(). Throws as check_functions() does.
FmuFunctions load_functions(void* library, const LibraryOwner& owner);

}  // namespace mebots::master
