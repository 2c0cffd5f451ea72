// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace mebots::soc {

/// The extension that a core must have for a row in the tables of instructions. `user` is a property of a core that
/// adds no instructions.
enum class Extension : std::uint8_t {
  standard,  // RV32IMC_Zicsr_Zifencei with machine mode
  xpulp,     // Xpulp v2 as in RI5CY
  a,
  f,
  zfinx,  // operations of F on integer registers
  zba,
  zbb,
  zbc,
  zbs,
  user,  // user mode
};

/// A set of extensions. The set always contains `standard`.
class Extensions {
 public:
  constexpr Extensions() = default;
  constexpr Extensions(Extension extension) { add(extension); }  // NOLINT: one extension is a set, too

  constexpr bool has(Extension extension) const { return (bits_ & bit(extension)) != 0; }
  constexpr void add(Extension extension) { bits_ |= bit(extension); }
  constexpr Extensions with(Extension extension) const {
    auto more = *this;
    more.add(extension);
    return more;
  }
  /// Returns true if the core has floating-point operations, on separate registers (F) or on integer registers (Zfinx).
  constexpr bool has_floats() const { return has(Extension::f) || has(Extension::zfinx); }
  bool operator==(const Extensions&) const = default;

 private:
  static constexpr std::uint32_t bit(Extension extension) { return 1U << static_cast<unsigned>(extension); }

  std::uint32_t bits_ = bit(Extension::standard);
};

/// All extensions that a core can have at the same time. Zfinx is not included, because F excludes it.
inline constexpr auto kMostExtensions = [] {
  Extensions most;
  for (const auto extension : {Extension::xpulp, Extension::a, Extension::f, Extension::zba, Extension::zbb,
                               Extension::zbc, Extension::zbs, Extension::user}) {
    most.add(extension);
  }
  return most;
}();

/// Parses an ISA string such as "rv32imafc_zicsr_zba_zbb". The letter `u` means user mode. The result never contains
/// Xpulp. Throws Error if the text is not an ISA string, if an extension is unsupported, if i, m or c is missing, or if
/// the text contains both f and zfinx.
Extensions read_isa(std::string_view text);

/// Returns the ISA string of a set, such as "rv32imac_zicsr_zifencei_zba". Leaves out Xpulp.
std::string isa_string(Extensions extensions);

/// Returns the optional extension with this name, such as "A" or "Zba", or `standard` if no optional extension has this
/// name.
Extension optional_extension(std::string_view name);

// Numbers of registers: x0 to x31 are 0 to 31, and f0 to f31 follow.
inline constexpr unsigned kFirstFloat = 32;
inline constexpr unsigned kRegisters = 64;

}  // namespace mebots::soc
