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

/// Reads programs in the format ELF32 for RISC-V. Source: Tool Interface Standard, ELF 1.2; RISC-V ELF psABI 1.0.
namespace mebots::soc {

/// A loadable segment. The load address differs from the run address if the linker script uses `AT>`. The bytes are
/// stored at the load address, as Spike, QEMU and a flash programmer do. The program's start-up code copies them to the
/// run address.
struct ElfSegment {
  std::uint32_t load_address = 0;   // p_paddr: address at which `bytes` are stored
  std::uint32_t run_address = 0;    // p_vaddr: address at which the program expects the bytes
  std::vector<std::uint8_t> bytes;  // content of the file; empty for .bss and NOLOAD sections
  std::uint32_t size = 0;           // bytes at the run address; those that the file lacks are 0 after reset
};

struct ElfSymbol {
  std::string_view name;  // valid as long as the Elf or a copy of it exists
  std::uint32_t address = 0;
  std::uint32_t size = 0;
  bool function = false;

  /// Returns the name as in C++ source, such as "Gauge::read() const" for _ZNK5Gauge4readEv.
  std::string shown() const;
};

/// A program that was read from its file and checked.
class Elf {
 public:
  /// Throws Error if the bytes are not a complete little-endian ELF32 executable for RISC-V (RV32, without registers
  /// for double precision). Error messages name the file `origin`.
  static Elf parse(std::span<const std::uint8_t> file, const std::string& origin);
  static Elf read(const std::filesystem::path& path);

  const std::string& origin() const { return origin_; }
  /// Returns the load address of the first instruction, even if the file's entry point is a run address.
  std::uint32_t entry() const { return entry_; }
  /// Returns the extensions in the file's attributes (Tag_RISCV_arch), such as "rv32i2p1_m2p0_c2p0", or an empty text
  /// if the file has no such attribute.
  const std::string& architecture() const { return architecture_; }
  /// Returns true if the program passes arguments in floating-point registers (-mabi=ilp32f), so that it needs a core
  /// with F.
  bool uses_float_registers() const { return uses_float_registers_; }
  const std::vector<ElfSegment>& segments() const { return segments_; }
  std::optional<std::uint32_t> symbol(std::string_view name) const;
  /// Returns all symbols that have an address, sorted by address. Excludes mapping symbols ($x, $d, $xrv32imc...) and
  /// the compiler's local labels (.L...).
  const std::vector<ElfSymbol>& symbols() const { return symbols_; }
  /// Returns the function or object that contains an address, otherwise the label to which the address belongs,
  /// otherwise null.
  const ElfSymbol* covering(std::uint32_t address) const;
  /// Returns a text such as "camera_handler+0x12 (camera.c:41)". The text has no line if the program was compiled
  /// without -g, and is empty if no symbol contains the address.
  std::string where(std::uint32_t address) const;
  /// Returns the text of where() for a return address, but with the source line of the call.
  std::string where_called(std::uint32_t return_address) const;
  /// Returns the address ranges of all source lines. The list is empty if the program was compiled without -g.
  std::vector<LineRange> line_ranges() const;

 private:
  std::string name_of(std::uint32_t address, std::uint32_t line_of) const;

  std::string origin_;
  std::uint32_t entry_ = 0;
  bool uses_float_registers_ = false;
  std::string architecture_;
  std::vector<ElfSegment> segments_;
  std::shared_ptr<const std::string> names_;  // storage of the symbols' names
  std::vector<ElfSymbol> symbols_;            // sorted by address
  std::shared_ptr<const LineSections> lines_;
};

/// Returns the attribute Tag_RISCV_arch of a section .riscv.attributes, such as "rv32i2p1_m2p0_c2p0". The text is empty
/// if the section is damaged or has no such attribute. Source: RISC-V ELF psABI 1.0, chapter "Attributes".
std::string architecture_in(std::span<const std::uint8_t> attributes);

}  // namespace mebots::soc
