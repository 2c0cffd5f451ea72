// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "isa/encoding.hpp"

#include <cstdint>
#include <string>
#include <string_view>

/// Identifies instructions of RISC-V extensions that the core lacks, for error messages.
namespace mebots::soc {

/// Names an instruction, or a group of instructions, and its extension.
struct ForeignInstruction {
  std::string_view name;       // such as "amoadd.w" or "a load of a float"; empty = unknown
  std::string_view extension;  // such as "A" or "RV64I"
};

/// Returns the instruction that `word` encodes in a ratified extension of RISC-V. If there is no such instruction, its
/// name is empty. Source: The RISC-V Instruction Set Manual, volumes I and II, 20240411, chapters of each extension.
ForeignInstruction foreign_instruction(std::uint32_t word);

/// Returns a text that names an illegal instruction and a way to avoid it, or an empty text if the instruction is
/// unknown. `has` contains the extensions of the core. `architecture` is the result of Elf::architecture() for the
/// program, or empty.
std::string advice_for_illegal(std::uint32_t word, Extensions has, std::string_view architecture);

}  // namespace mebots::soc
