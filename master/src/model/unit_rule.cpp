// SPDX-License-Identifier: Apache-2.0
#include "model/unit_rule.hpp"

#include "mebots/error.hpp"

#include <fmt/format.h>

namespace mebots::master {

modeldesc::UnitConversion conversion_between(const modeldesc::Unit& from, const modeldesc::Unit& to, bool difference) {
  if (!from.has_base || !to.has_base) {
    if (from.name == to.name) return {};
    throw Error(ErrorCode::wrong_unit,
                fmt::format("the units differ: [{}] and [{}], and the description does not define [{}]", from.name,
                            to.name, from.has_base ? to.name : from.name));
  }
  if (!modeldesc::same_dimension(from, to)) {
    throw Error(ErrorCode::wrong_unit,
                fmt::format("the units differ in dimension: [{}] is {} and [{}] is {}", from.name,
                            modeldesc::base_unit_text(from), to.name, modeldesc::base_unit_text(to)));
  }
  return modeldesc::unit_conversion(from, to, difference);
}

}  // namespace mebots::master
