// SPDX-License-Identifier: Apache-2.0
// Releases memory when the FMU's library is unloaded.
#include <dlfcn.h>

// GCC's C++ library reserves memory (72 kB per copy of the library) for exceptions that are thrown when memory is
// exhausted. This function releases the memory. libc++ does not have the function.
namespace __gnu_cxx {            // NOLINT(bugprone-reserved-identifier): theirs
[[gnu::weak]] void __freeres();  // NOLINT(bugprone-reserved-identifier,readability-identifier-naming)
}

namespace {

bool is_linked_in(const void* address, const void* own) {
  Dl_info theirs{};
  Dl_info ours{};
  return dladdr(address, &theirs) != 0 && dladdr(own, &ours) != 0 && theirs.dli_fbase == ours.dli_fbase;
}

/// Runs after all other destructors, which may throw and catch exceptions.
[[gnu::destructor(101)]] void give_back_exception_pool() {
  void (*const give_back)() = &__gnu_cxx::__freeres;
  // If the C++ library is shared with other libraries, does not release its memory.
  if (give_back != nullptr &&
      is_linked_in(reinterpret_cast<const void*>(give_back), reinterpret_cast<const void*>(&is_linked_in)))
    give_back();
}

}  // namespace
