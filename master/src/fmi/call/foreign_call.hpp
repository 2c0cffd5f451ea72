// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmi/call/forked_copies.hpp"
#include "mebots/error.hpp"

#include <cxxabi.h>

#include <cstdint>
#include <string>
#include <type_traits>

namespace mebots::master {

/// Thrown if a C++ exception leaves foreign code through its C interface. The message contains the exception's type and
/// text.
class ForeignException : public Error {
 public:
  explicit ForeignException(const std::string& text) : Error(ErrorCode::fmu_failed, text) {}
};

/// Returns text such as "threw std::runtime_error (it diverged) through its C interface". Must be called in a catch
/// block.
std::string escaped_exception_text();

/// Reports the busy runs as failed and ends the process. Must be called when foreign code is ending the thread that
/// called this code, because this end cannot be prevented.
[[noreturn]] void end_with_thread();

/// Calls foreign code and returns the result of `work`. Converts an exception to ForeignException. If the call returns
/// in a forked copy of the process, ends the copy. If the foreign code ends the thread, ends the process. The function
/// is inlined, because passing arguments in memory costs as much as the step of a small FMU.
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

/// The floating-point environment of a thread: rounding, trapped exceptions and flushing of denormals. Contains the
/// MXCSR register without the sticky flags, and the x87 control word. Any library can change them for code that runs on
/// the thread later. On machines other than x86-64, all objects are equal, and enter() has no effect.
struct FloatEnvironment {
  std::uint32_t mxcsr = 0x1f80;
  std::uint16_t x87 = 0x037f;  ///< the defaults of both registers: IEEE 754, rounding to nearest, no traps

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
