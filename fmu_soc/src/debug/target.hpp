// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "soc/soc.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace mebots::soc::debug {

struct Range {
  std::uint32_t address = 0;
  std::uint32_t size = 0;
};

/// Parses a hexadecimal number such as "1c000000". Returns nullopt if the text is not a number of at most 32 bits.
std::optional<std::uint32_t> parse_hex(std::string_view text);
/// Parses an address and a size in hexadecimal digits, such as "1c000000,4". Returns nullopt if one of them is invalid.
std::optional<Range> parse_range(std::string_view text);
/// Parses a 32-bit word from eight hexadecimal digits, least significant byte first. Returns nullopt for any other
/// text.
std::optional<std::uint32_t> parse_little_endian(std::string_view text);
std::string little_endian(std::uint32_t value);

std::string to_hex(std::string_view bytes);
std::optional<std::string> from_hex(std::string_view text);

/// Presents the chip's harts to gdb as threads: thread n + 1 is hart n. Harts of a cluster that is off keep their
/// thread numbers.
class Threads {
 public:
  explicit Threads(Soc& soc) : soc_(soc) {}

  /// Returns the number of the hart that gdb inspects: the hart that gdb has chosen or that stopped last.
  unsigned chosen() const { return chosen_; }
  Hart& hart() { return soc_.hart(chosen_); }
  const Hart& hart() const { return std::as_const(soc_).hart(chosen_); }
  void choose(unsigned number) { chosen_ = number; }

  /// Returns the hart that belongs to a thread number in gdb's format. The numbers 0 (any) and -1 (all) mean the chosen
  /// hart. Returns nullopt if there is no such hart.
  std::optional<unsigned> parse(std::string_view text) const;
  /// Returns the numbers of all threads in gdb's format, such as "m1,2,3".
  std::string list() const;
  /// Returns the text that `info threads` shows after the number.
  std::string describe(unsigned number) const;
  /// Returns the time of the chosen hart. If that hart is off, returns the time of the fabric controller.
  Picoseconds time() const { return soc_.core_time(soc_.is_on(chosen_) ? chosen_ : kFabricControllerHart); }

 private:
  Soc& soc_;
  unsigned chosen_ = kFabricControllerHart;
};

inline constexpr unsigned kPcNumber = 32;
inline constexpr unsigned kFirstCsrNumber = 65;  // number that gdb uses for the first CSR

/// Returns the description of the core's registers for gdb: x0 to x31, pc and the CSRs.
/// Source: Debugging with GDB, appendix "Target Descriptions", section "RISC-V Features".
std::string target_description();

}  // namespace mebots::soc::debug
