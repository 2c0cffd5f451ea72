// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <cstdlib>

/// MEBOTS_ASSERT(condition) and MEBOTS_ASSERT(condition, "why it holds") state what the code around relies on: an index
/// inside its array, an order of calls, an invariant of a class. Where it does not hold, our own code is wrong: file,
/// line, function and condition go to stderr and the process aborts. Input from outside gets a mebots::Error instead.
///
/// On where MEBOTS_ASSERTIONS is defined (presets dev, ci and the sanitizers'). Elsewhere (preset release) the
/// condition is compiled but never evaluated: it costs nothing and its variables count as used. A condition with a
/// comma outside of parentheses needs parentheses of its own.
#ifdef MEBOTS_ASSERTIONS
#define MEBOTS_ASSERT(condition, ...) \
  (static_cast<bool>(condition)       \
       ? static_cast<void>(0)         \
       : ::mebots::assertion_failed(#condition, __FILE_NAME__, __LINE__, __func__ __VA_OPT__(, ) __VA_ARGS__))
#else
#define MEBOTS_ASSERT(condition, ...) static_cast<void>(sizeof(static_cast<bool>(condition)))
#endif

namespace mebots {

/// stdio, because it works without memory and before main.
[[noreturn, gnu::cold]] inline void assertion_failed(const char* condition, const char* file, int line,
                                                     const char* function, const char* why = nullptr) noexcept {
  std::fprintf(stderr, "%s:%d: %s: assertion failed: %s%s%s\n", file, line, function, condition,
               why == nullptr ? "" : ": ", why == nullptr ? "" : why);
  std::fflush(stderr);
  std::abort();
}

}  // namespace mebots
