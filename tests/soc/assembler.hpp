// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elf/elf.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::soc::test {

/// Assembles and links a program with Debian's cross compiler, which also runs the C preprocessor. `_start` is the
/// entry.
Elf assemble(std::string_view text, std::uint32_t address = 0x80000000);
/// Assembles a program, with more options for the compiler. Returns the bytes of the ELF file.
std::vector<std::uint8_t> assemble_file(std::string_view text, std::uint32_t address = 0x80000000,
                                        std::string_view options = {});
/// Returns objdump's output for the code bytes, whose first byte is at address 0. Each element is one line.
std::vector<std::string> disassemble_with_objdump(const std::vector<std::uint8_t>& code);

}  // namespace mebots::soc::test
