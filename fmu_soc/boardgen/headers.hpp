// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board/board_file.hpp"

#include <string>

namespace mebots::soc {
struct BoardDescription;
}

namespace mebots::boardgen {

// Generate headers with addresses, register offsets, interrupts and named values of a board: a C header for firmware
// and assembler code, and a C++ header for device models.
std::string c_header(const soc::BoardDescription& board);
std::string cpp_header(const soc::BoardDescription& board);

/// Converts a name to upper case with underscores: TIME_LO stays TIME_LO, and FlightMode becomes FLIGHT_MODE.
std::string macro_case(const std::string& name);
/// TIME_LO -> TimeLo.
std::string camel_case(const std::string& name);
/// Converts a name to lower case with underscores: TIME_LO becomes time_lo, and range_finder.distance becomes
/// range_finder_distance.
std::string snake_case(const std::string& name);

/// Generates the source of a library with one kind of device: registers, states with energy and delays, opcodes,
/// variables, saving and restoring. Only the device's own behaviour is missing.
std::string skeleton(const soc::BoardDescription& board, const soc::BoardDevice& device);

}  // namespace mebots::boardgen
