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

/// The value of a variable. A Real is stored as double; a whole number, an enumeration or a Boolean as std::int64_t; a
/// String or a Binary as std::string.
using LinkValue = std::variant<double, std::int64_t, std::string>;

/// A connection within a group that transfers values only in event mode. A number is converted to factor * value +
/// offset. A whole number or a Boolean is first replaced according to `map`.
struct DiscreteLink {
  std::size_t from = 0;  ///< index of the member in the group
  std::size_t to = 0;
  ValueKind from_kind = ValueKind::real;
  ValueKind to_kind = ValueKind::real;
  ValueReference from_reference = 0;
  ValueReference to_reference = 0;
  double factor = 1;
  double offset = 0;
  std::vector<std::pair<std::int64_t, std::int64_t>> map = {};  ///< sorted in ascending order

  /// Reads the output of `source` and returns the converted value for the input.
  LinkValue read(Slave& source) const;
};

/// These functions call the access function of `slave` for this kind of variable.
LinkValue get_value(Slave& slave, ValueKind kind, ValueReference reference);
void set_value(Slave& slave, ValueKind kind, ValueReference reference, const LinkValue& value);

/// Returns whether two values are equal. Doubles are compared by their bits.
bool is_same(const LinkValue& a, const LinkValue& b);

}  // namespace mebots::master
