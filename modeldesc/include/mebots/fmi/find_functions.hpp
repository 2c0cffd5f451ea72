// SPDX-License-Identifier: Apache-2.0
#pragma once

#if defined(_WIN32)
#include <windows.h>
#else
#include <dlfcn.h>
#endif

#include <string>
#include <type_traits>

namespace mebots::fmi {

/// Stores a pointer to a member as a compile-time constant: `kMember<&Functions::do_step>()` returns the pointer.
template <auto pointer>
inline constexpr std::integral_constant<decltype(pointer), pointer> kMember{};

/// Returns the address of a symbol in a loaded library; null if the library lacks the symbol.
inline void* find_symbol(void* library, const std::string& name) {
#if defined(_WIN32)
  return reinterpret_cast<void*>(GetProcAddress(static_cast<HMODULE>(library), name.c_str()));
#else
  return dlsym(library, name.c_str());
#endif
}

/// Looks up the functions of an FMU in a loaded library. Returns a table of pointers, which are null for missing
/// functions. `Functions` is the table's type for a version of FMI. `for_each_function` calls its argument with the
/// name and the member of each function. In the library, each name begins with `prefix`.
template <typename Functions, typename ForEach>
Functions find_functions(void* library, ForEach for_each_function, const std::string& prefix = {}) {
  Functions functions;
  for_each_function([&](const char* name, auto member, auto /*need*/) {
    auto& function = functions.*member();
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(find_symbol(library, prefix + name));
  });
  return functions;
}

}  // namespace mebots::fmi
