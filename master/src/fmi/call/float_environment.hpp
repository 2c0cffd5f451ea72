// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace mebots::master {

/// How a thread computes: rounding, which exceptions trap, what becomes of tiny numbers (MXCSR without its sticky
/// flags, x87 control word). Any library can change it for whoever computes in the thread after it. On other machines
/// than x86-64 all are equal, and nothing is changed.
struct FloatEnvironment {
  std::uint32_t mxcsr = 0x1f80;
  std::uint16_t x87 = 0x037f;  ///< both: IEEE 754 to nearest, no traps

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

/// How `found` differs from `wanted`: "rounding upward, denormals are flushed to zero".
std::string difference_text(const FloatEnvironment& found, const FloatEnvironment& wanted);

}  // namespace mebots::master
