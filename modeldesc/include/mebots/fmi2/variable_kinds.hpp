// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

/// Type, causality, variability and initial of a variable, with the words of FMI 2.0.
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
