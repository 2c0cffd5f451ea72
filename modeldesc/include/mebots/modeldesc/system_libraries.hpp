// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

/// Determines whether a library is part of the operating system.
namespace mebots::modeldesc {

/// Returns true for libraries that every desktop or server Linux with glibc contains, and for libraries of sanitizers.
bool is_part_of_linux(std::string_view soname);

/// Returns true for a DLL that every 64-bit Windows 10 or newer contains. The case of the name does not matter, as on
/// Windows.
bool is_part_of_windows(std::string_view dll);

}  // namespace mebots::modeldesc
