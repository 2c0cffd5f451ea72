// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/units.hpp"

namespace mebots::master {

/// Returns the conversion from one unit to another. If one of the units has no definition, both must have the same
/// name. Otherwise, both must have the same dimension. If `difference` is true, offsets of units are ignored, because
/// the value is a difference. Throws Error (wrong_unit) with the reason if there is no conversion.
modeldesc::UnitConversion conversion_between(const modeldesc::Unit& from, const modeldesc::Unit& to, bool difference);

}  // namespace mebots::master
