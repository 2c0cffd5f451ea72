// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/fmu/binary_ref.hpp"
#include "model/value_kind.hpp"

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace mebots::master {

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

/// Where the three stand in a list of references; nothing when one of them is not there.
std::optional<std::array<std::size_t, 3>> places_of(const OsmpTriple& triple,
                                                    std::span<const ValueReference> references);

}  // namespace mebots::master
