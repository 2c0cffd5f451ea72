// SPDX-License-Identifier: Apache-2.0
// Throws C++ exceptions through the probe FMU's C interface.
#include <cstring>
#include <stdexcept>

extern "C" void probe_throw(const char* kind);

extern "C" void probe_throw(const char* kind) {
  // NOLINTNEXTLINE(bugprone-std-exception-baseclass): a type that no handler of std::exception catches
  if (std::strcmp(kind, "throw_number") == 0) throw 42;
  throw std::domain_error("the solver diverged");
}
