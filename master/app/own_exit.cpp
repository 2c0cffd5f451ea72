// SPDX-License-Identifier: Apache-2.0
//
// _exit() and _Exit() of this program. The dynamic linker gives a program's functions to its libraries before those of
// the C library, so an FMU that calls one ends here. The C library itself, in exit() say, does not.
#include "run/exit_guard.hpp"

#include <sys/syscall.h>
#include <unistd.h>

#include <cstdlib>

namespace {

[[noreturn]] void end(const char* function, int status) {
  mebots::master::end_busy_runs(function);
  for (;;) syscall(SYS_exit_group, status);
}

}  // namespace

// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming): the C library's names
extern "C" {

[[gnu::visibility("default")]] void _exit(int status) {
  end("_exit", status);
}

[[gnu::visibility("default")]] void _Exit(int status) noexcept {
  end("_Exit", status);
}

}  // extern "C"
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)
