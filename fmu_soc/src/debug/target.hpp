// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "soc/soc.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

/// Numbers and bytes as gdb's remote protocol writes them.
namespace mebots::soc::debug {

struct Range {
  std::uint32_t address = 0;
  std::uint32_t size = 0;
};

/// Parses "1c000000". Returns nullopt if the text is empty, no number, or longer than 32 bits.
std::optional<std::uint32_t> parse_hex(std::string_view text);
/// "1c000000,4"
std::optional<Range> parse_range(std::string_view text);
/// Four bytes in the order of memory.
std::optional<std::uint32_t> parse_little_endian(std::string_view text);
std::string little_endian(std::uint32_t value);

std::string to_hex(std::string_view bytes);
std::optional<std::string> from_hex(std::string_view text);

/// The chip's harts as gdb's threads: thread n + 1 is hart n. Those of a cluster that is off are there, too: so gdb
/// numbers them as we do.
class Threads {
 public:
  explicit Threads(Soc& soc) : soc_(soc) {}

  /// The hart that gdb looks at: the one that was stopped, unless gdb chose another.
  unsigned chosen() const { return chosen_; }
  Hart& hart() { return soc_.hart(chosen_); }
  const Hart& hart() const { return std::as_const(soc_).hart(chosen_); }
  void choose(unsigned number) { chosen_ = number; }

  /// The hart of a thread's number as gdb writes it; its 0 and -1, any and all, are the chosen one. Nothing when there
  /// is none.
  std::optional<unsigned> parse(std::string_view text) const;
  /// "m1,2,3"
  std::string list() const;
  /// What `info threads` shows behind the number.
  std::string describe(unsigned number) const;
  /// When the chosen hart's next instruction starts, or its sleep began; of the fabric controller when that one is off.
  Picoseconds time() const { return soc_.core_time(soc_.is_on(chosen_) ? chosen_ : kFabricControllerHart); }

 private:
  Soc& soc_;
  unsigned chosen_ = kFabricControllerHart;
};

inline constexpr unsigned kPcNumber = 32;
inline constexpr unsigned kFirstCsrNumber = 65;  // as gdb numbers them

/// Returns the description of the core's registers for gdb: x0 to x31, pc and the CSRs.
/// Source: Debugging with GDB, appendix "Target Descriptions", section "RISC-V Features".
std::string target_description();

}  // namespace mebots::soc::debug
