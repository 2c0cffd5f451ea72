// SPDX-License-Identifier: Apache-2.0
//
// Replaces functions that end, replace or copy the process. The dynamic linker prefers a program's functions to those
// of the C library, so an FMU calls the functions in this file. Calls inside the C library, such as in exit() or
// system(), do not use these functions.
#include "fmi/call/exit_guard.hpp"

#include <dlfcn.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdarg>
#include <cstdlib>
#include <vector>

namespace {

[[noreturn]] void end(const char* what, int status) {
  mebots::master::end_busy_runs(what);
  for (;;) syscall(SYS_exit_group, status);
}

/// A function of the C library. Looks up its address at the start of the program, because a forked process must not
/// call the loader.
template <typename Target>
class Original {
 public:
  explicit Original(const char* name)
      : function_(reinterpret_cast<int (*)(Target, char* const*, char* const*)>(dlsym(RTLD_NEXT, name))) {}
  int operator()(Target target, char* const* words, char* const* environment) const {
    return function_(target, words, environment);
  }

 private:
  int (*function_)(Target, char* const*, char* const*);
};

const Original<const char*> kOriginalExecve("execve");
const Original<const char*> kOriginalExecvpe("execvpe");
const Original<int> kOriginalFexecve("fexecve");

/// Returns the arguments of execl() and similar functions with the terminating null.
std::vector<char*> listed(const char* first, std::va_list& more) {
  std::vector<char*> words{const_cast<char*>(first)};
  while (words.back() != nullptr) words.push_back(va_arg(more, char*));
  return words;
}

}  // namespace

// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming,cert-dcl50-cpp): the C library's interface
extern "C" {

[[gnu::visibility("default")]] void _exit(int status) {
  end("called _exit()", status);
}

[[gnu::visibility("default")]] void _Exit(int status) noexcept {
  end("called _Exit()", status);
}

[[gnu::visibility("default")]] int execve(const char* path, char* const* words, char* const* environment) noexcept {
  mebots::master::end_busy_runs("called execve()");
  return kOriginalExecve(path, words, environment);
}

[[gnu::visibility("default")]] int execv(const char* path, char* const* words) noexcept {
  mebots::master::end_busy_runs("called execv()");
  return kOriginalExecve(path, words, environ);
}

[[gnu::visibility("default")]] int execvpe(const char* file, char* const* words, char* const* environment) noexcept {
  mebots::master::end_busy_runs("called execvpe()");
  return kOriginalExecvpe(file, words, environment);
}

[[gnu::visibility("default")]] int execvp(const char* file, char* const* words) noexcept {
  mebots::master::end_busy_runs("called execvp()");
  return kOriginalExecvpe(file, words, environ);
}

[[gnu::visibility("default")]] int fexecve(int file, char* const* words, char* const* environment) noexcept {
  mebots::master::end_busy_runs("called fexecve()");
  return kOriginalFexecve(file, words, environment);
}

[[gnu::visibility("default")]] int execl(const char* path, const char* first, ...) noexcept {
  mebots::master::end_busy_runs("called execl()");
  std::va_list more;
  va_start(more, first);
  const auto words = listed(first, more);
  va_end(more);
  return kOriginalExecve(path, words.data(), environ);
}

[[gnu::visibility("default")]] int execlp(const char* file, const char* first, ...) noexcept {
  mebots::master::end_busy_runs("called execlp()");
  std::va_list more;
  va_start(more, first);
  const auto words = listed(first, more);
  va_end(more);
  return kOriginalExecvpe(file, words.data(), environ);
}

[[gnu::visibility("default")]] int execle(const char* path, const char* first, ...) noexcept {
  mebots::master::end_busy_runs("called execle()");
  std::va_list more;
  va_start(more, first);
  const auto words = listed(first, more);
  auto* const* environment = va_arg(more, char* const*);
  va_end(more);
  return kOriginalExecve(path, words.data(), environment);
}

/// Copies the process like fork(), which POSIX permits. With shared memory, the child could return from the FMU's call
/// undetected.
[[gnu::visibility("default")]] pid_t vfork() noexcept {
  return fork();
}

}  // extern "C"
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming,cert-dcl50-cpp)
