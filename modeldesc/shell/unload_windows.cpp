// SPDX-License-Identifier: Apache-2.0
// Releases memory when the FMU's library is unloaded, as unload.cpp does. A DLL always has its own copy of the C++
// library.

namespace __gnu_cxx {  // NOLINT(bugprone-reserved-identifier): theirs
void __freeres();      // NOLINT(bugprone-reserved-identifier,readability-identifier-naming)
}

namespace {

/// Runs after all other destructors, which may throw and catch exceptions.
[[gnu::destructor(101)]] void give_back_exception_pool() {
  __gnu_cxx::__freeres();
}

}  // namespace
