// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "slave/slave.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace mebots::master {

/// A variable's value: double for reals; std::int64_t for whole numbers, enumerations and Booleans; std::string for
/// Strings and Binaries.
using LinkValue = std::variant<double, std::int64_t, std::string>;

/// A connection within a group that transfers values in event mode only. Numbers become factor * value + offset; whole
/// numbers and Booleans are first replaced by their entry in `map`.
struct DiscreteLink {
  std::size_t from = 0;  ///< index of the member in the group
  std::size_t to = 0;
  ValueKind from_kind = ValueKind::real;
  ValueKind to_kind = ValueKind::real;
  ValueReference from_reference = 0;
  ValueReference to_reference = 0;
  double factor = 1;
  double offset = 0;
  std::vector<std::pair<std::int64_t, std::int64_t>> map = {};  ///< ascending

  /// Returns the value for the input. `source` is the instance of the output.
  LinkValue read(Slave& source) const;
};

/// Calls the access function of `slave` for this kind of variable.
LinkValue get_value(Slave& slave, ValueKind kind, ValueReference reference);
void set_value(Slave& slave, ValueKind kind, ValueReference reference, const LinkValue& value);

/// Returns whether two values are equal. Doubles are compared by their bits.
bool is_same(const LinkValue& a, const LinkValue& b);

}  // namespace mebots::master
