// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "soc/program_host.hpp"
#include "soc/soc.hpp"
#include "tool/host_files.hpp"

#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace mebots::soc::tool {

/// Implements the Linux system calls that C libraries for bare-metal programs use. A program calls them through ecall
/// or `tohost`. Negative results are -errno. Numbers: Linux, include/uapi/asm-generic/unistd.h; from 1024 on newlib,
/// libgloss/riscv/machine/syscall.h.
class SystemCalls {
 public:
  static constexpr std::uint32_t kOpenAt = 56;

  SystemCalls(Soc& soc, HostFiles& files) : soc_(soc), files_(files) {}

  /// Prepares the fabric controller for a program that expects an operating system. The stack, with the arguments in
  /// Linux's form, is at the end of the program's RAM. The heap starts after the program. Throws Error if the RAM is
  /// too small.
  void begin_program(const std::vector<std::string>& arguments);

  HostReply serve(std::uint32_t number, std::span<const std::uint32_t> arguments);

  std::optional<std::string> text_at(std::uint32_t address, std::uint32_t length) const;
  /// Reads a zero-terminated text from memory. Returns nullopt if the text is too long or not in memory.
  std::optional<std::string> text_at(std::uint32_t address) const;
  /// Reads from or writes to a file. Returns the number of bytes, or -errno.
  long transfer(bool is_read, int file, std::uint32_t address, std::uint32_t count);
  /// Returns the simulated time, because the host's time would differ between runs.
  std::uint64_t time_in(std::uint64_t per_second) const;
  void report_once(const std::string& request);

 private:
  bool poke(std::uint32_t address, std::span<const std::uint64_t> words);
  /// Opens the file whose name is at address `name`. `flags` are those of the host's open().
  long open(std::uint32_t name, int flags);
  long write_parts(int file, std::uint32_t parts, std::uint32_t count);
  long status(int file, std::uint32_t address);
  long move_break(std::uint32_t address);
  long tell_time(std::uint32_t address, std::uint64_t per_second);
  long refuse(std::uint32_t number);

  Soc& soc_;
  HostFiles& files_;
  std::uint32_t break_ = 0;        // end of the heap, which the program can move
  std::uint32_t least_break_ = 0;  // end of the program, where the heap starts
  std::uint32_t most_break_ = 0;
  std::set<std::string> reported_;  // unknown requests that were reported
};

/// Returns the name of a system call, such as "futex", or an empty text if the number is unknown.
std::string_view system_call_name(std::uint32_t number);

}  // namespace mebots::soc::tool
