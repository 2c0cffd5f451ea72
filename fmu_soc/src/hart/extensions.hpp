// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "isa/encoding.hpp"

#include <cstdint>
#include <string>
#include <string_view>

/// Instructions of RISC-V extensions that the core lacks, for messages.
namespace mebots::soc {

/// An instruction or a group of instructions, and its extension.
struct ForeignInstruction {
  std::string_view name;       // "amoadd.w", "a load of a float"; empty: unknown
  std::string_view extension;  // "A", "RV64I"
};

/// Returns the instruction that the word encodes in a ratified extension of RISC-V. If there is no such instruction,
/// the name in the result is empty. Source: The RISC-V Instruction Set Manual, volumes I and II, 20240411, chapters of
/// each extension.
ForeignInstruction foreign_instruction(std::uint32_t word);

/// Returns a text with the name of an illegal instruction and a way to avoid it. The text is empty if the instruction
/// is unknown. `has` contains the extensions of the core. `architecture` is the architecture of the program from
/// Elf::architecture(), or empty.
std::string advice_for_illegal(std::uint32_t word, Extensions has, std::string_view architecture);

}  // namespace mebots::soc
