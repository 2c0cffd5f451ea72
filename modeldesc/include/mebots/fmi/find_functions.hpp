// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <dlfcn.h>

#include <string>
#include <type_traits>

namespace mebots::fmi {

/// Looks up the functions of an FMU in a library from dlopen(); those that it lacks are null. `Functions` is the table
/// of a version of FMI. `for_each_function` calls its argument with the name and the member of each function. `prefix`
/// precedes each name in the library.
template <typename Functions, typename ForEach>
Functions find_functions(void* library, ForEach for_each_function, const std::string& prefix = {}) {
  Functions functions;
  for_each_function([&](const char* name, auto member, auto /*need*/) {
    auto& function = functions.*member;
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(dlsym(library, (prefix + name).c_str()));
  });
  return functions;
}

}  // namespace mebots::fmi
