// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elf/elf.hpp"
#include "soc/hardware.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace mebots::soc {

struct HostReply {
  std::uint32_t value = 0;
  std::optional<std::uint32_t> exit_code = {};  // if set, the run ends with this exit code

  static HostReply exit(std::uint32_t code) { return {0, code}; }
};

/// Executes the calls that a program makes to the host. No time passes on the chip during a call.
class HostCalls {
 public:
  HostCalls() = default;
  HostCalls(const HostCalls&) = delete;
  HostCalls& operator=(const HostCalls&) = delete;
  virtual ~HostCalls() = default;

  /// Executes a semihosting call: slli x0, x0, 31; ebreak; srai x0, x0, 7, with the operation in a0 and its parameter
  /// in a1. Source: RISC-V Semihosting 1.0, which adopts the operations of Arm's "Semihosting for AArch32 and AArch64".
  virtual HostReply semihosting(std::uint32_t operation, std::uint32_t parameter) = 0;
  /// Executes a system call through `tohost`, with seven arguments. Source: riscv-isa-sim, fesvr/syscall.cc.
  virtual HostReply system_call(std::uint32_t number, std::span<const std::uint32_t> arguments) = 0;
  /// Executes a system call through ecall: number in a7, six arguments from a0, result in a0. Source: RISC-V Linux;
  /// newlib, libgloss/riscv.
  virtual HostReply environment_call(std::uint32_t number, std::span<const std::uint32_t> arguments) = 0;
  /// Executes a command that the program sends through `tohost` to another device than that of system calls. The
  /// command has no reply.
  virtual void device_command(unsigned device, unsigned command, std::uint64_t payload) = 0;
};

/// Detects the calls of a program to the host: semihosting, ecalls, and commands that the program stores to the word
/// `tohost`, for example to end. Calls are only executed in `mebots-soc run`, without FMI. Not part of a saved state.
class ProgramHost {
 public:
  ProgramHost(Hardware& hardware, const Elf& program) : hardware_(hardware), program_(program) {}

  /// Watches the word at this address as `tohost`. Throws Error if no memory contains the word.
  void watch(std::uint32_t address);
  /// Sets the object that executes the calls; null removes it. If `serves_ecall` is true, an ecall is a system call.
  /// Otherwise it is an exception.
  void serve(HostCalls* calls, bool serves_ecall = false) {
    calls_ = calls;
    serves_ecall_ = calls != nullptr && serves_ecall;
  }

  /// Returns the value of the watched word, including its upper half if it has one; 0 = no command.
  std::uint64_t command() const;
  /// Returns true if the program is about to store the other half of this command, so that the command will change. A
  /// 32-bit core may store the two halves in either order.
  bool is_half_stored(std::uint64_t command) const;
  /// Executes a command. Returns true if the command ends the program.
  bool serve_command(std::uint64_t command);
  /// Executes the command that a cluster core has just stored to `tohost`, before this core's next instruction. Returns
  /// true if the command ends the program.
  bool serve_stored() { return command() != 0 && serve_command(command()); }
  /// Executes the semihosting call at the fabric controller's pc. Returns false if the ebreak there is no semihosting
  /// call.
  bool serve_semihosting();
  bool serves_environment_calls() const { return serves_ecall_; }
  /// Serves the ecall at the fabric controller's pc. If ecall is an exception, returns false.
  bool serve_environment_call();

  /// Returns the exit code of a program that has ended itself by a semihosting call or an ecall, otherwise nullopt.
  std::optional<std::uint32_t> exit_code() const { return exit_code_; }
  /// Returns the name of the function that the fabric controller executes, or an empty text if it is unknown.
  std::string function() const { return program_.where(hardware_.controller().pc()); }

 private:
  void clear_command();
  bool serve_system_call(std::uint32_t block);

  Hardware& hardware_;
  const Elf& program_;
  std::optional<std::uint32_t> stop_word_;
  /// True if `tohost` has 64 bits. Only then can a command contain the number of a device.
  bool has_upper_half_ = false;
  HostCalls* calls_ = nullptr;
  bool serves_ecall_ = false;
  std::optional<std::uint32_t> exit_code_;
};

}  // namespace mebots::soc
