// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace mebots::boardgen {

/// TIME_LO of flight or FlightMode -> TIME_LO, FLIGHT_MODE.
std::string macro_case(const std::string& name);
/// TIME_LO -> TimeLo.
std::string camel_case(const std::string& name);
/// TIME_LO, range_finder.distance -> time_lo, range_finder_distance.
std::string snake_case(const std::string& name);

}  // namespace mebots::boardgen
