// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmi/call/forked_copies.hpp"
#include "mebots/error.hpp"

#include <cxxabi.h>

#include <cstdint>
#include <string>
#include <type_traits>

namespace mebots::master {

/// A C++ exception left foreign code through its C interface. The message contains its type and its text.
class ForeignException : public Error {
 public:
  explicit ForeignException(const std::string& text) : Error(ErrorCode::fmu_failed, text) {}
};

/// Must be called in a catch block. Returns text such as "threw std::runtime_error (it diverged) through its C
/// interface".
std::string escaped_exception_text();

/// Called when foreign code is ending the thread that called this code, which cannot be prevented. Reports the busy
/// runs as failed and ends the process.
[[noreturn]] void end_with_thread();

/// Calls foreign code and returns the result of `work`. The call can end only by a return. An exception becomes a
/// ForeignException. If the call returns in a forked copy of the process, the copy is ended. If the foreign code ends
/// the thread, the process ends. The function is inlined, because passing arguments in memory costs as much as a small
/// FMU's step.
template <typename Work>
[[gnu::always_inline]] inline std::invoke_result_t<Work&> call_foreign(Work work) {
  try {
    if constexpr (std::is_void_v<std::invoke_result_t<Work&>>) {
      work();
      if (is_forked_copy()) [[unlikely]]
        end_forked_copy();
    } else {
      auto result = work();
      if (is_forked_copy()) [[unlikely]]
        end_forked_copy();
      return result;
    }
  } catch (abi::__forced_unwind&) {
    end_with_thread();
  } catch (...) {
    if (is_forked_copy()) end_forked_copy();
    throw ForeignException(escaped_exception_text());
  }
}

/// The floating-point environment of a thread: rounding, trapped exceptions and flushing of denormals. It consists of
/// the MXCSR register without the sticky flags, and the x87 control word. Any library can change it for later code on
/// the thread. On machines other than x86-64 all objects are equal, and nothing is changed.
struct FloatEnvironment {
  std::uint32_t mxcsr = 0x1f80;
  std::uint16_t x87 = 0x037f;  ///< default of both: IEEE 754 to nearest, no traps

#if defined(__x86_64__)
  static FloatEnvironment now() {
    constexpr std::uint32_t kControl = 0xffc0;
    FloatEnvironment found;
    asm volatile("stmxcsr %0\n\tfnstcw %1" : "=m"(found.mxcsr), "=m"(found.x87));
    found.mxcsr &= kControl;
    return found;
  }
  void enter() const {
    asm volatile("ldmxcsr %0\n\tfldcw %1" : : "m"(mxcsr), "m"(x87));
  }
#else
  static FloatEnvironment now() {
    return {};
  }
  void enter() const {}
#endif

  bool operator==(const FloatEnvironment&) const = default;
};

/// Returns a text that describes the differences between `found` and `wanted`, such as "rounding upward, denormals are
/// flushed to zero".
std::string difference_text(const FloatEnvironment& found, const FloatEnvironment& wanted);

}  // namespace mebots::master
