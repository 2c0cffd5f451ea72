// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/fmu/binary_ref.hpp"
#include "mebots/modeldesc/model_description.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Defines the forms in which the master and FMUs exchange values.
namespace mebots::master {

/// The handle by which FMI identifies a variable.
using ValueReference = std::uint32_t;

/// The form in which the master stores a value, for all versions of FMI. `real` stores Float64 and Float32 as double.
/// `integer` stores whole numbers of 8 to 64 bits and enumerations as std::int64_t (a UInt64 by its bits). `boolean`
/// stores 0 or 1, `string` a text, `binary` bytes in a std::string. `clock` states whether a clock is active at an
/// instant, in event mode only.
enum class ValueKind : std::uint8_t { real, integer, boolean, string, binary, clock };

constexpr ValueKind kind_of(modeldesc::Type type) {
  using modeldesc::Type;
  switch (type) {
    case Type::real:
    case Type::float32:
      return ValueKind::real;
    case Type::boolean:
      return ValueKind::boolean;
    case Type::string:
      return ValueKind::string;
    case Type::binary:
      return ValueKind::binary;
    case Type::clock:
      return ValueKind::clock;
    default:
      return ValueKind::integer;
  }
}

/// True for types whose values are numbers or Booleans.
constexpr bool is_number(modeldesc::Type type) {
  return kind_of(type) == ValueKind::real || kind_of(type) == ValueKind::integer || kind_of(type) == ValueKind::boolean;
}

/// True for Clocks and for variables that belong to a Clock. Such variables can be read and set only at a tick.
inline bool is_clocked(const modeldesc::Variable& variable) {
  return variable.type == modeldesc::Type::clock || !variable.fmi3->clocks.empty();
}

/// Formats a whole number. The bits of a UInt64 are interpreted as unsigned.
std::string whole_text(modeldesc::Type type, std::int64_t value);

/// Returns the double that is nearest to a whole number. The bits of a UInt64 are interpreted as unsigned.
constexpr double number_of(modeldesc::Type type, std::int64_t value) {
  return type == modeldesc::Type::uint64 ? static_cast<double>(static_cast<std::uint64_t>(value))
                                         : static_cast<double>(value);
}

/// A set of ValueKinds, stored with one bit for each kind.
using KindSet = std::uint8_t;
constexpr KindSet bit(ValueKind kind) {
  return static_cast<KindSet>(1U << static_cast<unsigned>(kind));
}

/// The suffixes of the three Integers that form an OSMP binary.
inline constexpr const char* kOsmpEndings[] = {".base.lo", ".base.hi", ".size"};

/// True for an Integer that is one of the three parts of an OSMP binary: one half of a pointer, or the size of a
/// buffer. OSMP annotations mark these Integers. If there are no annotations, the names `x.base.lo`, `x.base.hi` and
/// `x.size` identify them.
bool is_osmp_part(const modeldesc::ModelDescription& description, const modeldesc::Variable& variable);

/// The three Integers that form an OSMP binary. The address in them is not valid in another process.
struct OsmpTriple {
  std::array<ValueReference, 3> references;  // base.lo, base.hi, size
};

/// Returns all OSMP binaries of an FMU.
std::vector<OsmpTriple> osmp_triples(const modeldesc::ModelDescription& description);

/// Returns the indices of the triple's three references in `references`. Returns nullopt if one of them is missing.
std::optional<std::array<std::size_t, 3>> places_of(const OsmpTriple& triple,
                                                    std::span<const ValueReference> references);

}  // namespace mebots::master
