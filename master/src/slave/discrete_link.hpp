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

/// The value of a variable: double for a Real, std::int64_t for a whole number, an enumeration or a Boolean,
/// std::string for a String or a Binary.
using LinkValue = std::variant<double, std::int64_t, std::string>;

/// A connection within a group whose value is transferred in event mode. The input is factor * value + offset. Whole
/// numbers and Booleans are replaced according to `map` before that.
struct DiscreteLink {
  std::size_t from = 0;  ///< index of the member in the group
  std::size_t to = 0;
  ValueKind from_kind = ValueKind::real;
  ValueKind to_kind = ValueKind::real;
  ValueReference from_reference = 0;
  ValueReference to_reference = 0;
  double factor = 1;
  double offset = 0;
  std::vector<std::pair<std::int64_t, std::int64_t>> map = {};  ///< in ascending order

  LinkValue read(Slave& source) const;
};

/// Calls the access function of `slave` for `kind`.
LinkValue get_value(Slave& slave, ValueKind kind, ValueReference reference);
void set_value(Slave& slave, ValueKind kind, ValueReference reference, const LinkValue& value);

/// True if two values are equal. Doubles are compared by their bits.
bool is_same(const LinkValue& a, const LinkValue& b);

}  // namespace mebots::master
