// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmi/fmu.hpp"
#include "mebots/fmi2/library.hpp"

#include <string>

namespace mebots::master {

/// What fmi2GetTypesPlatform must say: the sizes of the standard's own header.
inline constexpr const char* kTypesPlatform = "default";

/// Looks the functions up in a library from dlopen. Throws InputError listing those that are missing and without which
/// no simulation runs (`mebots check` asks for all); `archive` names the FMU in it.
Fmi2Functions load_functions(void* library, const std::string& archive);

}  // namespace mebots::master
