// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

namespace mebots::soc {

/// Opens a shared library. The library is closed when the last copy of the returned handle is destroyed. Throws Error
/// with the operating system's reason.
std::shared_ptr<void> open_library(const std::filesystem::path& file);

/// Returns the address of a symbol, or null if the library does not define it.
void* find_symbol(void* library, const char* name);

}  // namespace mebots::soc
