// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <cstdlib>

/// MEBOTS_ASSERT(condition) and MEBOTS_ASSERT(condition, "why it holds") check an assumption of the surrounding code:
/// an index inside its array, an order of calls, an invariant of a class. A false condition is a bug in MEbots. The
/// macro then prints file, line, function and condition to stderr and aborts the process. For wrong input from outside,
/// throw a mebots::Error instead.
///
/// The macro is active if MEBOTS_ASSERTIONS is defined (presets dev, ci, and the presets of the sanitizers). Otherwise
/// (preset release), the condition is compiled but not evaluated. Its variables count as used. If the condition
/// contains a comma outside of parentheses, put the whole condition in parentheses.
#ifdef MEBOTS_ASSERTIONS
#define MEBOTS_ASSERT(condition, ...) \
  (static_cast<bool>(condition)       \
       ? static_cast<void>(0)         \
       : ::mebots::assertion_failed(#condition, __FILE_NAME__, __LINE__, __func__ __VA_OPT__(, ) __VA_ARGS__))
#else
#define MEBOTS_ASSERT(condition, ...) static_cast<void>(sizeof(static_cast<bool>(condition)))
#endif

namespace mebots {

/// Uses stdio, because stdio also works before main() and if memory is exhausted.
[[noreturn, gnu::cold]] inline void assertion_failed(const char* condition, const char* file, int line,
                                                     const char* function, const char* why = nullptr) noexcept {
  std::fprintf(stderr, "%s:%d: %s: assertion failed: %s%s%s\n", file, line, function, condition,
               why == nullptr ? "" : ": ", why == nullptr ? "" : why);
  std::fflush(stderr);
  std::abort();
}

}  // namespace mebots
