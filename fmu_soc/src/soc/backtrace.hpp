// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elf/elf.hpp"
#include "memory/memory.hpp"

#include <cstdint>
#include <string>

namespace mebots::soc::debug {

/// Returns a text with the callers found in ra and on the stack, innermost first: "fly+0x1a (pilot.c:12) < main+0x44
/// (main.c:90)". Returns an empty text if no caller is found. A word on the stack counts as a return address if it is
/// the address after a call instruction of the program. It may belong to an earlier call that has already returned.
std::string backtrace(const Elf& program, const Memory& memory, std::uint32_t return_address,
                      std::uint32_t stack_pointer);

}  // namespace mebots::soc::debug
