// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/units.hpp"

namespace mebots::master {

/// Returns the conversion from one unit to another. Equal names without definitions are the same unit; otherwise both
/// must be defined and have the same dimension. `difference`: the value is a difference of two, so offsets do not
/// apply. Throws Error (wrong_unit) with the reason.
modeldesc::UnitConversion conversion_between(const modeldesc::Unit& from, const modeldesc::Unit& to, bool difference);

}  // namespace mebots::master
