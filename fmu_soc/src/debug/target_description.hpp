// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace mebots::soc::debug {

inline constexpr unsigned kPcNumber = 32;
inline constexpr unsigned kFirstCsrNumber = 65;  // as gdb numbers them

/// The registers of the core as gdb wants to be told them: x0 to x31, pc and the CSRs.
/// Source: Debugging with GDB, appendix "Target Descriptions", section "RISC-V Features".
std::string target_description();

}  // namespace mebots::soc::debug
