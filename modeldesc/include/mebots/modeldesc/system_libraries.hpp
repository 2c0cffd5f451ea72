// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace mebots::modeldesc {

/// True for libraries that every desktop or server Linux with glibc contains, and for libraries of sanitizers.
bool is_part_of_linux(std::string_view soname);

/// True for a DLL that every 64-bit Windows 10 or newer contains. Ignores the case of the name.
bool is_part_of_windows(std::string_view dll);

}  // namespace mebots::modeldesc
