// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace mebots::soc {
struct BoardDescription;
}

namespace mebots::boardgen {

// What a board description says about addresses, register offsets, interrupts and named values. As a C header for the
// firmware (also fit for the assembler), and as a C++ header for the device models.
std::string c_header(const soc::BoardDescription& board);
std::string cpp_header(const soc::BoardDescription& board);

}  // namespace mebots::boardgen
