// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmi/call/forked_copies.hpp"
#include "mebots/error.hpp"

#include <cxxabi.h>

#include <cstdint>
#include <string>
#include <type_traits>

namespace mebots::master {

/// Thrown if a C++ exception leaves an FMU through its C interface. The message contains the type and text of the
/// exception.
class ForeignException : public Error {
 public:
  explicit ForeignException(const std::string& text) : Error(ErrorCode::fmu_failed, text) {}
};

/// Describes the current exception, such as "threw std::runtime_error (it diverged) through its C interface". Must be
/// called in a catch block.
std::string escaped_exception_text();

/// Calls end_busy_runs() and ends the process. Must be called while an FMU is ending the current thread, because the
/// end of the thread cannot be prevented.
[[noreturn]] void end_with_thread();

/// Calls `work`, which calls an FMU, and returns its result. Converts an exception to ForeignException. If the call
/// returns in a forked copy of the process, ends the copy. If the FMU ends the thread, ends the process. Inlined,
/// because passing arguments in memory takes as long as the step of a small FMU.
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
/// the MXCSR register without the sticky flags, and the x87 control word. Any library can change it. On machines other
/// than x86-64, all objects are equal and enter() has no effect.
struct FloatEnvironment {
  std::uint32_t mxcsr = 0x1f80;
  std::uint16_t x87 = 0x037f;  ///< default of both registers: IEEE 754, rounding to nearest, no traps

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

/// Describes the differences between `found` and `wanted`, such as "rounding upward, denormals are flushed to zero".
std::string difference_text(const FloatEnvironment& found, const FloatEnvironment& wanted);

}  // namespace mebots::master
