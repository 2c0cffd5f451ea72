// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/fmu/binary_ref.hpp"
#include "mebots/modeldesc/model_description.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

/// How values travel between the master and an FMU.
namespace mebots::master {

/// FMI's handle of a variable.
using ValueReference = std::uint32_t;

/// The types of FMI's access functions. Enumerations travel as Integers, Booleans as 0 and 1.
enum class ValueKind { real, integer, boolean, string };

constexpr ValueKind kind_of(modeldesc::Type type) {
  switch (type) {
    case modeldesc::Type::real:
      return ValueKind::real;
    case modeldesc::Type::boolean:
      return ValueKind::boolean;
    case modeldesc::Type::string:
      return ValueKind::string;
    case modeldesc::Type::integer:
    case modeldesc::Type::enumeration:
      break;
  }
  return ValueKind::integer;
}

/// One bit per ValueKind.
using KindSet = std::uint8_t;
constexpr KindSet bit(ValueKind kind) {
  return static_cast<KindSet>(1U << static_cast<unsigned>(kind));
}

/// Endings of the three Integers of a binary variable.
inline constexpr const char* kOsmpEndings[] = {".base.lo", ".base.hi", ".size"};

/// True for Integers that carry a pointer's half or a buffer's size, by their OSMP mark or, lacking one,
/// by their names `x.base.lo`, `x.base.hi` and `x.size`.
bool is_osmp_part(const modeldesc::ModelDescription& description, const modeldesc::Variable& variable);

/// The three Integers of one OSMP binary variable, whose address means nothing in another process.
struct OsmpTriple {
  std::array<ValueReference, 3> references;  // base.lo, base.hi, size
};

/// All binary variables of an FMU.
std::vector<OsmpTriple> osmp_triples(const modeldesc::ModelDescription& description);

/// Returns the places of the three in a list of references, or nullopt if one is absent.
std::optional<std::array<std::size_t, 3>> places_of(const OsmpTriple& triple,
                                                    std::span<const ValueReference> references);

}  // namespace mebots::master
