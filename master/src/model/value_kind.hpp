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

namespace mebots::master {

/// The handle by which FMI identifies a variable.
using ValueReference = std::uint32_t;

/// The type in which the master stores a value. `real` stores a double, also for Float32. `integer` stores a
/// std::int64_t for whole numbers of 8 to 64 bits (a UInt64 by its bits) and for enumerations. `boolean` stores 0 or 1.
/// `string` and `binary` store a std::string. `clock` states whether a clock is active, in event mode only.
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

/// True for numbers and Booleans.
constexpr bool is_number(modeldesc::Type type) {
  return kind_of(type) == ValueKind::real || kind_of(type) == ValueKind::integer || kind_of(type) == ValueKind::boolean;
}

/// True for clocks and clocked variables. They can be read and set only while their clock is active.
inline bool is_clocked(const modeldesc::Variable& variable) {
  return variable.type == modeldesc::Type::clock || !variable.fmi3->clocks.empty();
}

/// Formats a whole number. Interprets the bits of a UInt64 as unsigned.
std::string whole_text(modeldesc::Type type, std::int64_t value);

/// Returns the double nearest to a whole number. Interprets the bits of a UInt64 as unsigned.
constexpr double number_of(modeldesc::Type type, std::int64_t value) {
  return type == modeldesc::Type::uint64 ? static_cast<double>(static_cast<std::uint64_t>(value))
                                         : static_cast<double>(value);
}

/// A set of ValueKinds with one bit for each kind.
using KindSet = std::uint8_t;
constexpr KindSet bit(ValueKind kind) {
  return static_cast<KindSet>(1U << static_cast<unsigned>(kind));
}

/// The suffixes of the names of the three Integers of an OSMP binary.
inline constexpr const char* kOsmpEndings[] = {".base.lo", ".base.hi", ".size"};

/// True for one of the three Integers of an OSMP binary: the two halves of a pointer, and the size of a buffer. The
/// annotations of OSMP mark these Integers. In an FMU without annotations, the names `x.base.lo`, `x.base.hi` and
/// `x.size` identify them.
bool is_osmp_part(const modeldesc::ModelDescription& description, const modeldesc::Variable& variable);

/// The three Integers of an OSMP binary. The pointer in them is not valid in another process.
struct OsmpTriple {
  std::array<ValueReference, 3> references;  // base.lo, base.hi, size
};

std::vector<OsmpTriple> osmp_triples(const modeldesc::ModelDescription& description);

/// Returns the positions of the three value references of `triple` in `references`; nullopt if one of them is missing.
std::optional<std::array<std::size_t, 3>> places_of(const OsmpTriple& triple,
                                                    std::span<const ValueReference> references);

}  // namespace mebots::master
