// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elf/elf.hpp"
#include "hart/hart.hpp"
#include "memory/memory.hpp"

#include <string>

namespace mebots::soc::debug {

/// Who called whom, as far as ra and the stack tell, innermost first: "fly+0x1a < main+0x44". Words on the stack count
/// when they point behind a call instruction of the program; an old one may be among them. Empty when there is none.
std::string backtrace(const Elf& program, const Memory& memory, const Hart& hart);

}  // namespace mebots::soc::debug
