// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elf/elf.hpp"
#include "memory/memory.hpp"

#include <cstdint>
#include <string>

namespace mebots::soc::debug {

/// Who called whom, as far as ra and the stack tell, innermost first: "fly+0x1a (pilot.c:12) < main+0x44 (main.c:90)".
/// Words on the stack count when they point behind a call instruction of the program; an old one may be among them.
/// Empty when there is none.
std::string backtrace(const Elf& program, const Memory& memory, std::uint32_t return_address,
                      std::uint32_t stack_pointer);

}  // namespace mebots::soc::debug
