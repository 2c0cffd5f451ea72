// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

namespace mebots::soc {

/// Opens a shared library. The library is closed when the last copy of the returned handle is destroyed. Throws Error
/// with the system's reason.
std::shared_ptr<void> open_library(const std::filesystem::path& file);

/// Returns a symbol's address; null if the library lacks it.
void* find_symbol(void* library, const char* name);

}  // namespace mebots::soc
