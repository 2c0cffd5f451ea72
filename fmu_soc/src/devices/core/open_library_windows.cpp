// SPDX-License-Identifier: Apache-2.0
#include "devices/core/open_library.hpp"

#include "mebots/error.hpp"

#include <fmt/format.h>
#include <windows.h>

#include <system_error>

namespace mebots::soc {

std::shared_ptr<void> open_library(const std::filesystem::path& file) {
  std::shared_ptr<void> library(LoadLibraryW(file.c_str()), [](void* handle) {
    if (handle != nullptr) FreeLibrary(static_cast<HMODULE>(handle));
  });
  if (library) return library;
  const auto why = std::system_category().message(static_cast<int>(GetLastError()));
  throw Error(ErrorCode::file_unreadable,
              fmt::format("{}: cannot be opened as a library of devices: {}", file.string(), why));
}

void* find_symbol(void* library, const char* name) {
  return reinterpret_cast<void*>(GetProcAddress(static_cast<HMODULE>(library), name));
}

}  // namespace mebots::soc
