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

/// The value of a variable: of a real; of a whole number, an enumeration or a Boolean; of a String or a Binary.
using LinkValue = std::variant<double, std::int64_t, std::string>;

/// A connection within a group of instances that carries values in event mode only. Numbers become factor * value +
/// offset; whole numbers and Booleans are mapped first.
struct DiscreteLink {
  std::size_t from = 0;  ///< member of the group
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

/// Calls the function of `slave` for values of this kind.
LinkValue get_value(Slave& slave, ValueKind kind, ValueReference reference);
void set_value(Slave& slave, ValueKind kind, ValueReference reference, const LinkValue& value);

/// Compares doubles by their bits.
bool is_same(const LinkValue& a, const LinkValue& b);

}  // namespace mebots::master
