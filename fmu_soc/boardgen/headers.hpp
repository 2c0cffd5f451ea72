// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board/board_file.hpp"

#include <string>

namespace mebots::soc {
struct BoardDescription;
}

namespace mebots::boardgen {

// Generate a C header for firmware and assembler code, and a C++ header for device models. Both contain the board's
// addresses, register offsets, interrupts and named values.
std::string c_header(const soc::BoardDescription& board);
std::string cpp_header(const soc::BoardDescription& board);

/// Converts a name to upper case with underscores: FlightMode becomes FLIGHT_MODE.
std::string macro_case(const std::string& name);
/// Converts a name to upper camel case: TIME_LO becomes TimeLo.
std::string camel_case(const std::string& name);
/// Converts a name to lower case with underscores: TIME_LO becomes time_lo.
std::string snake_case(const std::string& name);

/// Generates the C++ source of a library with a model of one device: registers, states with energy and delays, opcodes,
/// variables, saving and restoring. The device's own behaviour must be added by hand.
std::string skeleton(const soc::BoardDescription& board, const soc::BoardDevice& device);

}  // namespace mebots::boardgen
