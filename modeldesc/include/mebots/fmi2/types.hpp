// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

/// The C types of FMI 2.0 (functional mock-up interface standard, version 2.0.4, sections 2.1 and 4.2), as far as
/// co-simulation needs them. Names and values are the standard's: they are the binary interface.
// NOLINTBEGIN(readability-identifier-naming)
extern "C" {

using fmi2Component = void*;
using fmi2ComponentEnvironment = void*;
using fmi2FMUstate = void*;
using fmi2ValueReference = unsigned int;
using fmi2Real = double;
using fmi2Integer = int;
using fmi2Boolean = int;
using fmi2Char = char;
using fmi2String = const fmi2Char*;
using fmi2Byte = char;

inline constexpr fmi2Boolean fmi2True = 1;
inline constexpr fmi2Boolean fmi2False = 0;

enum fmi2Status { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending };
enum fmi2Type { fmi2ModelExchange, fmi2CoSimulation };
enum fmi2StatusKind { fmi2DoStepStatus, fmi2PendingStatus, fmi2LastSuccessfulTime, fmi2Terminated };

using fmi2CallbackLogger = void (*)(fmi2ComponentEnvironment environment, fmi2String instance_name, fmi2Status status,
                                    fmi2String category, fmi2String message, ...);
using fmi2CallbackAllocateMemory = void* (*)(std::size_t count, std::size_t size);
using fmi2CallbackFreeMemory = void (*)(void* memory);
using fmi2StepFinished = void (*)(fmi2ComponentEnvironment environment, fmi2Status status);

struct fmi2CallbackFunctions {
  fmi2CallbackLogger logger;
  fmi2CallbackAllocateMemory allocateMemory;
  fmi2CallbackFreeMemory freeMemory;
  fmi2StepFinished stepFinished;
  fmi2ComponentEnvironment componentEnvironment;
};

}  // extern "C"
// NOLINTEND(readability-identifier-naming)

namespace mebots::fmi2 {

/// As the standard spells it; FMUs may answer anything.
constexpr std::string_view status_name(fmi2Status status) {
  switch (status) {
    case fmi2OK:
      return "fmi2OK";
    case fmi2Warning:
      return "fmi2Warning";
    case fmi2Discard:
      return "fmi2Discard";
    case fmi2Error:
      return "fmi2Error";
    case fmi2Fatal:
      return "fmi2Fatal";
    case fmi2Pending:
      return "fmi2Pending";
  }
  return "a status that FMI 2.0 does not know";
}

}  // namespace mebots::fmi2

/// What FMI 2.0 says of a variable beside its name and value, with the standard's words.
namespace mebots::fmi2 {

enum class Type : std::uint8_t { real, integer, boolean, string, enumeration };
enum class Causality : std::uint8_t { parameter, calculated_parameter, input, output, local, independent };
enum class Variability : std::uint8_t { constant, fixed, tunable, discrete, continuous };
enum class Initial : std::uint8_t { exact, approx, calculated };

// The words of each in the order of its values.
inline constexpr std::string_view kTypeWords[] = {"Real", "Integer", "Boolean", "String", "Enumeration"};
inline constexpr std::string_view kCausalityWords[] = {"parameter", "calculatedParameter", "input", "output",
                                                       "local",     "independent"};
inline constexpr std::string_view kVariabilityWords[] = {"constant", "fixed", "tunable", "discrete", "continuous"};
inline constexpr std::string_view kInitialWords[] = {"exact", "approx", "calculated"};

constexpr std::string_view to_string(Type type) {
  return kTypeWords[static_cast<std::size_t>(type)];
}
constexpr std::string_view to_string(Causality causality) {
  return kCausalityWords[static_cast<std::size_t>(causality)];
}
constexpr std::string_view to_string(Variability variability) {
  return kVariabilityWords[static_cast<std::size_t>(variability)];
}
constexpr std::string_view to_string(Initial initial) {
  return kInitialWords[static_cast<std::size_t>(initial)];
}

static_assert(to_string(Type::enumeration) == "Enumeration" && to_string(Causality::independent) == "independent" &&
              to_string(Variability::continuous) == "continuous" && to_string(Initial::calculated) == "calculated");

}  // namespace mebots::fmi2
