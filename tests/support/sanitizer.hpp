// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace mebots::test {

/// True if the address or thread sanitizer is active. The sanitizer then handles the signals of a crash first, and
/// controls heap and address space.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitizerTakesCrashesAndMemory = true;
#else
inline constexpr bool kSanitizerTakesCrashesAndMemory = false;
#endif

}  // namespace mebots::test
