// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace mebots::soc {

struct BoardDescription;

/// Tag_RISCV_arch in a section .riscv.attributes, such as "rv32i2p1_m2p0_c2p0"; empty if the section is damaged or has
/// none. Source: RISC-V ELF psABI 1.0, chapter "Attributes".
std::string architecture_in(std::span<const std::uint8_t> attributes);

/// The chip that a program of GreenWaves' SDKs was built for, when that is another one than GAP8; empty when it is not
/// known. Told by the SDK's own headers among the debug information: the file says nothing of it elsewhere (its note
/// "Pulp_Info" reads chip=none), and the chips' memory maps overlap.
std::string_view other_chip_of(std::string_view elf_bytes);

/// On GAP8's own memory map, a program for another chip would run into the weeds. Throws Error for one; a file that
/// cannot be read is told where it is loaded.
void require_own_chip(const std::filesystem::path& program, const BoardDescription& board);

}  // namespace mebots::soc
