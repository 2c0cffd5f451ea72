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

/// The subset of Linux's system calls that C libraries without an operating system use. A program makes them by ecall
/// or through `tohost`. Results are 0 or more, or -errno. Numbers: Linux, include/uapi/asm-generic/unistd.h; from 1024
/// on newlib, libgloss/riscv/machine/syscall.h.
class SystemCalls {
 public:
  static constexpr std::uint32_t kOpenAt = 56;

  SystemCalls(Soc& soc, HostFiles& files) : soc_(soc), files_(files) {}

  /// Prepares the fabric controller for a program that expects an operating system. The stack is at the end of the RAM
  /// that contains the program, with the arguments in Linux's form; the heap is after the program. Throws Error if
  /// there is not enough memory.
  void begin_program(const std::vector<std::string>& arguments);

  HostReply serve(std::uint32_t number, std::span<const std::uint32_t> arguments);

  std::optional<std::string> text_at(std::uint32_t address, std::uint32_t length) const;
  /// Reads a text up to its final zero.
  std::optional<std::string> text_at(std::uint32_t address) const;
  /// Returns the number of bytes, or -errno.
  long transfer(bool is_read, int file, std::uint32_t address, std::uint32_t count);
  /// Returns simulated time. The host's time would differ between runs.
  std::uint64_t time_in(std::uint64_t per_second) const;
  void report_once(const std::string& request);

 private:
  bool poke(std::uint32_t address, std::span<const std::uint64_t> words);
  /// `flags` has the values of the host's open().
  long open(std::uint32_t name, int flags);
  long write_parts(int file, std::uint32_t parts, std::uint32_t count);
  long status(int file, std::uint32_t address);
  long move_break(std::uint32_t address);
  long tell_time(std::uint32_t address, std::uint64_t per_second);
  long refuse(std::uint32_t number);

  Soc& soc_;
  HostFiles& files_;
  std::uint32_t break_ = 0;        // end of the heap
  std::uint32_t least_break_ = 0;  // end of the program
  std::uint32_t most_break_ = 0;
  std::set<std::string> reported_;  // unknown requests that have been reported
};

/// Returns the name of a system call, such as "futex"; empty if it is unknown.
std::string_view system_call_name(std::uint32_t number);

}  // namespace mebots::soc::tool
