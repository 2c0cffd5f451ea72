// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board/board_file.hpp"

#include <string>

namespace mebots::soc {
struct BoardDescription;
}

namespace mebots::boardgen {

// What a board description says about addresses, register offsets, interrupts and named values. As a C header for the
// firmware (also fit for the assembler), and as a C++ header for the device models.
std::string c_header(const soc::BoardDescription& board);
std::string cpp_header(const soc::BoardDescription& board);

/// TIME_LO of flight or FlightMode -> TIME_LO, FLIGHT_MODE.
std::string macro_case(const std::string& name);
/// TIME_LO -> TimeLo.
std::string camel_case(const std::string& name);
/// TIME_LO, range_finder.distance -> time_lo, range_finder_distance.
std::string snake_case(const std::string& name);

/// The source of a library of devices with one kind, complete but for what the device does by itself. Registers, states
/// with their energy and delays, opcodes, variables, saving and restoring are there.
std::string skeleton(const soc::BoardDescription& board, const soc::BoardDevice& device);

}  // namespace mebots::boardgen
