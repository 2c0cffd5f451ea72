// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace mebots::soc {

/// What a program gets back from the host.
struct HostReply {
  std::uint32_t value = 0;
  std::optional<std::uint32_t> exit_code = {};  // the program wants the run to end

  static HostReply exit(std::uint32_t code) { return {0, code}; }
};

/// Serves programs that call the host: a core that calls stands still meanwhile, and no time passes on the chip.
class HostCalls {
 public:
  HostCalls() = default;
  HostCalls(const HostCalls&) = delete;
  HostCalls& operator=(const HostCalls&) = delete;
  virtual ~HostCalls() = default;

  /// slli x0, x0, 31; ebreak; srai x0, x0, 7 with a0 and a1. Source: RISC-V Semihosting 1.0, which takes the operations
  /// of Arm's "Semihosting for AArch32 and AArch64".
  virtual HostReply semihosting(std::uint32_t operation, std::uint32_t parameter) = 0;
  /// A system call through `tohost`: seven arguments. Source: riscv-isa-sim, fesvr/syscall.cc.
  virtual HostReply system_call(std::uint32_t number, std::span<const std::uint32_t> arguments) = 0;
  /// A command through `tohost` to another device than that of system calls. Nothing is answered.
  virtual void device_command(unsigned device, unsigned command, std::uint64_t payload) = 0;
};

}  // namespace mebots::soc
