// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/units.hpp"

namespace mebots::master {

/// Returns the conversion from one unit to another. Units that have the same name and no definitions are the same unit.
/// If their names differ, both units must be defined and have the same dimension. If `difference` is true, the value is
/// a difference of two values, so that offsets do not apply. Throws Error (wrong_unit) with the reason if no conversion
/// exists.
modeldesc::UnitConversion conversion_between(const modeldesc::Unit& from, const modeldesc::Unit& to, bool difference);

}  // namespace mebots::master
