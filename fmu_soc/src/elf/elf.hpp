// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elf/source_lines.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Programs as ELF32 files for RISC-V. Source: Tool Interface Standard, ELF 1.2; RISC-V ELF psABI 1.0.
namespace mebots::soc {

/// A loadable segment. `AT>` in a linker script makes its two addresses differ: the bytes are stored at the load
/// address, as Spike, QEMU and a flash programmer do, and start-up code copies them to the run address.
struct ElfSegment {
  std::uint32_t load_address = 0;   // p_paddr: where `bytes` are stored
  std::uint32_t run_address = 0;    // p_vaddr: where the program expects them
  std::vector<std::uint8_t> bytes;  // from the file; empty for .bss and for NOLOAD sections
  std::uint32_t size = 0;           // at the run address; bytes that the file lacks are 0 after reset
};

struct ElfSymbol {
  std::string_view name;  // valid as long as its Elf or a copy of it
  std::uint32_t address = 0;
  std::uint32_t size = 0;
  bool function = false;

  /// The name as it is written in C++: "Gauge::read() const" for _ZNK5Gauge4readEv.
  std::string shown() const;
};

/// A program, checked and taken out of its file.
class Elf {
 public:
  /// Throws Error when the bytes are not a complete ELF32 little-endian executable for RISC-V (RV32, no
  /// floating-point registers). `origin` names the file in the text.
  static Elf parse(std::span<const std::uint8_t> file, const std::string& origin);
  static Elf read(const std::filesystem::path& path);

  const std::string& origin() const { return origin_; }
  /// First instruction. If the entry point is a run address, this is the load address of the same instruction.
  std::uint32_t entry() const { return entry_; }
  /// The extensions that the file's attributes name (Tag_RISCV_arch): "rv32i2p1_m2p0_c2p0"; empty without them.
  const std::string& architecture() const { return architecture_; }
  const std::vector<ElfSegment>& segments() const { return segments_; }
  std::optional<std::uint32_t> symbol(std::string_view name) const;
  /// All symbols that stand for an address, sorted by it. The marks that tell code from data ($x, $d, $xrv32imc...)
  /// and the compiler's local labels (.L...) are not among them.
  const std::vector<ElfSymbol>& symbols() const { return symbols_; }
  /// The function, or else the label, that covers an address; null when there is none.
  const ElfSymbol* covering(std::uint32_t address) const;
  /// "camera_handler+0x12 (camera.c:41)", without the line where the program was compiled without -g; "" when no symbol
  /// covers the address.
  std::string where(std::uint32_t address) const;
  /// The same for an address that a call returns to, with the line of the call.
  std::string where_called(std::uint32_t return_address) const;

 private:
  std::string name_of(std::uint32_t address, std::uint32_t line_of) const;

  std::string origin_;
  std::uint32_t entry_ = 0;
  std::string architecture_;
  std::vector<ElfSegment> segments_;
  std::shared_ptr<const std::string> names_;  // of the symbols
  std::vector<ElfSymbol> symbols_;            // by address
  std::shared_ptr<const LineSections> lines_;
};

/// Tag_RISCV_arch in a section .riscv.attributes, such as "rv32i2p1_m2p0_c2p0"; empty if the section is damaged or has
/// none. Source: RISC-V ELF psABI 1.0, chapter "Attributes".
std::string architecture_in(std::span<const std::uint8_t> attributes);

}  // namespace mebots::soc
