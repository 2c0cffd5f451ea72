// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/model_description.hpp"

#include <cstdint>

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

}  // namespace mebots::master
