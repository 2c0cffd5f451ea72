// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/units.hpp"

namespace mebots::master {

/// How a number goes from one unit to another. One name without definitions is one unit; else both must be defined, of
/// the same dimension. `difference`: of two values, so that offsets fall out. Throws Error (wrong_unit) saying why not.
modeldesc::UnitConversion conversion_between(const modeldesc::Unit& from, const modeldesc::Unit& to, bool difference);

}  // namespace mebots::master
