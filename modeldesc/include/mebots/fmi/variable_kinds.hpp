// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>
#include <span>
#include <string_view>

/// Defines the type, causality, variability and initial of a variable in the terms of FMI 3.0. FMI 2.0 has a subset of
/// these terms.
namespace mebots::fmi {

/// `real` is Real in FMI 2.0 and Float64 in FMI 3.0. `integer` is Integer in FMI 2.0 and Int32 in FMI 3.0. The types
/// after `enumeration` exist only in FMI 3.0.
enum class Type : std::uint8_t {
  real,
  integer,
  boolean,
  string,
  enumeration,
  float32,
  int8,
  uint8,
  int16,
  uint16,
  uint32,
  int64,
  uint64,
  binary,
  clock
};
/// The causalities after `independent` exist only in FMI 3.0.
enum class Causality : std::uint8_t {
  parameter,
  calculated_parameter,
  input,
  output,
  local,
  independent,
  structural_parameter,
  dependent
};
enum class Variability : std::uint8_t { constant, fixed, tunable, discrete, continuous };
enum class Initial : std::uint8_t { exact, approx, calculated };

// The words of each enumeration in modelDescription.xml, in the order of its values.
inline constexpr std::string_view kTypeWords2[] = {"Real", "Integer", "Boolean", "String", "Enumeration"};
inline constexpr std::string_view kTypeWords3[] = {"Float64", "Int32", "Boolean", "String", "Enumeration",
                                                   "Float32", "Int8",  "UInt8",   "Int16",  "UInt16",
                                                   "UInt32",  "Int64", "UInt64",  "Binary", "Clock"};
inline constexpr std::string_view kCausalityWords3[] = {
    "parameter", "calculatedParameter", "input", "output", "local", "independent", "structuralParameter", "dependent"};
inline constexpr std::span<const std::string_view> kCausalityWords2 = std::span(kCausalityWords3).first(6);
inline constexpr std::string_view kVariabilityWords[] = {"constant", "fixed", "tunable", "discrete", "continuous"};
// The words of FMI 1.0, which the reader converts to the words of FMI 2.0.
inline constexpr std::string_view kCausalityWords1[] = {"input", "output", "internal", "none"};
inline constexpr std::string_view kVariabilityWords1[] = {"constant", "parameter", "discrete", "continuous"};
inline constexpr std::string_view kAliasWords1[] = {"noAlias", "alias", "negatedAlias"};
inline constexpr std::string_view kInitialWords[] = {"exact", "approx", "calculated"};

/// Returns the name of a type in FMI 2.0. If the type exists only in FMI 3.0, returns its name there.
constexpr std::string_view to_string(Type type) {
  const auto place = static_cast<std::size_t>(type);
  return place < std::size(kTypeWords2) ? kTypeWords2[place] : kTypeWords3[place];
}
/// Returns the type with this name in FMI 3.0; empty if the name is unknown.
constexpr std::optional<Type> type_of_word3(std::string_view word) {
  const auto* const found = std::ranges::find(kTypeWords3, word);
  if (found == std::end(kTypeWords3)) return std::nullopt;
  return static_cast<Type>(found - std::begin(kTypeWords3));
}
constexpr std::string_view to_string(Causality causality) {
  return kCausalityWords3[static_cast<std::size_t>(causality)];
}
constexpr std::string_view to_string(Variability variability) {
  return kVariabilityWords[static_cast<std::size_t>(variability)];
}
constexpr std::string_view to_string(Initial initial) {
  return kInitialWords[static_cast<std::size_t>(initial)];
}

static_assert(to_string(Type::enumeration) == "Enumeration" && to_string(Causality::independent) == "independent" &&
              to_string(Variability::continuous) == "continuous" && to_string(Initial::calculated) == "calculated" &&
              to_string(Type::clock) == "Clock" && to_string(Causality::dependent) == "dependent");

constexpr bool is_float(Type type) {
  return type == Type::real || type == Type::float32;
}
/// True for whole numbers, including enumerations.
constexpr bool is_whole(Type type) {
  switch (type) {
    case Type::integer:
    case Type::enumeration:
    case Type::int8:
    case Type::uint8:
    case Type::int16:
    case Type::uint16:
    case Type::uint32:
    case Type::int64:
    case Type::uint64:
      return true;
    default:
      return false;
  }
}

/// The lowest and the highest value of a type of whole numbers. `high` is unsigned, because UInt64 exceeds 2^63 - 1.
struct WholeLimits {
  std::int64_t low;
  std::uint64_t high;
};
constexpr WholeLimits limits_of(Type type) {
  switch (type) {
    case Type::int8:
      return {-128, 127};
    case Type::uint8:
      return {0, 255};
    case Type::int16:
      return {-32768, 32767};
    case Type::uint16:
      return {0, 65535};
    case Type::uint32:
      return {0, UINT32_MAX};
    case Type::int64:
      return {INT64_MIN, INT64_MAX};
    case Type::uint64:
      return {0, UINT64_MAX};
    default:
      return {INT32_MIN, INT32_MAX};
  }
}

}  // namespace mebots::fmi
