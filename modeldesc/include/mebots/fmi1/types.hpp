// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>

/// Declares the C types of FMI 1.0 for co-simulation (functional mock-up interface for co-simulation 1.0, section 3.3).
/// Names and values are those of the standard, because they define the binary interface. Unlike in FMI 2.0, a Boolean
/// has one byte.
// NOLINTBEGIN(readability-identifier-naming)
extern "C" {

using fmiComponent = void*;
using fmiValueReference = unsigned int;
using fmiReal = double;
using fmiInteger = int;
using fmiBoolean = char;
using fmiString = const char*;

inline constexpr fmiBoolean fmiTrue = 1;
inline constexpr fmiBoolean fmiFalse = 0;

enum fmiStatus { fmiOK, fmiWarning, fmiDiscard, fmiError, fmiFatal, fmiPending };
enum fmiStatusKind { fmiDoStepStatus, fmiPendingStatus, fmiLastSuccessfulTime };

using fmiCallbackLogger = void (*)(fmiComponent component, fmiString instance_name, fmiStatus status,
                                   fmiString category, fmiString message, ...);
using fmiCallbackAllocateMemory = void* (*)(std::size_t count, std::size_t size);
using fmiCallbackFreeMemory = void (*)(void* memory);
using fmiStepFinished = void (*)(fmiComponent component, fmiStatus status);

/// The standard passes this structure by value.
struct fmiCallbackFunctions {
  fmiCallbackLogger logger;
  fmiCallbackAllocateMemory allocateMemory;
  fmiCallbackFreeMemory freeMemory;
  fmiStepFinished stepFinished;
};

}  // extern "C"
// NOLINTEND(readability-identifier-naming)

namespace mebots::fmi1 {

/// Returns the name of a status in the standard, such as "fmiError". For any other number, returns "an unknown status".
constexpr std::string_view status_name(int status) {
  constexpr std::string_view kNames[] = {"fmiOK", "fmiWarning", "fmiDiscard", "fmiError", "fmiFatal", "fmiPending"};
  return status >= fmiOK && status <= fmiPending ? kNames[status] : "an unknown status";
}

}  // namespace mebots::fmi1
