// SPDX-License-Identifier: Apache-2.0
// What an FMU gives back when its library is unloaded.
#include <dlfcn.h>

// GCC's C++ library sets memory aside for exceptions that are thrown when there is none left (72 kB), once per copy of
// the library, and gives it back on request only. libc++ has no such function.
namespace __gnu_cxx {            // NOLINT(bugprone-reserved-identifier): theirs
[[gnu::weak]] void __freeres();  // NOLINT(bugprone-reserved-identifier,readability-identifier-naming)
}

namespace {

bool is_linked_in(const void* address, const void* own) {
  Dl_info theirs{};
  Dl_info ours{};
  return dladdr(address, &theirs) != 0 && dladdr(own, &ours) != 0 && theirs.dli_fbase == ours.dli_fbase;
}

/// After all others: destructors may throw and catch.
[[gnu::destructor(101)]] void give_back_exception_pool() {
  void (*const give_back)() = &__gnu_cxx::__freeres;
  // A C++ library that others use too stays as it is.
  if (give_back != nullptr &&
      is_linked_in(reinterpret_cast<const void*>(give_back), reinterpret_cast<const void*>(&is_linked_in)))
    give_back();
}

}  // namespace
