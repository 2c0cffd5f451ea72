// SPDX-License-Identifier: Apache-2.0
#include "devices/core/open_library.hpp"

#include "mebots/error.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

namespace mebots::soc {

std::shared_ptr<void> open_library(const std::filesystem::path& file) {
  std::shared_ptr<void> library(dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL), [](void* handle) {
    if (handle != nullptr) dlclose(handle);
  });
  if (library) return library;
  const char* why = dlerror();
  throw Error(ErrorCode::file_unreadable,
              fmt::format("{}: cannot be opened as a library of devices: {}", file.string(), why ? why : "no reason"));
}

void* find_symbol(void* library, const char* name) {
  return dlsym(library, name);
}

}  // namespace mebots::soc
