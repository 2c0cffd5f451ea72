// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace mebots::test {

/// The address and the thread sanitizer answer the signals of a crash before anybody else, and have heap and address
/// space to themselves.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitizerTakesCrashesAndMemory = true;
#else
inline constexpr bool kSanitizerTakesCrashesAndMemory = false;
#endif

}  // namespace mebots::test
