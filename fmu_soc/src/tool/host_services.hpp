// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "soc/program_host.hpp"
#include "soc/soc.hpp"
#include "tool/host_files.hpp"
#include "tool/system_calls.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace mebots::soc::tool {

/// Serves a program that runs without FMI: console, files, simulated time and exit, by semihosting or system calls.
class HostServices final : public HostCalls {
 public:
  HostServices(Soc& soc, HostFiles& files, std::string program)
      : soc_(soc), files_(files), calls_(soc, files), program_(std::move(program)) {}

  /// Calls SystemCalls::begin_program() with the program's name as first argument.
  void begin_program(const std::string& name, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), name);
    calls_.begin_program(arguments);
  }

  HostReply semihosting(std::uint32_t operation, std::uint32_t parameter) override;
  HostReply system_call(std::uint32_t number, std::span<const std::uint32_t> arguments) override;
  HostReply environment_call(std::uint32_t number, std::span<const std::uint32_t> arguments) override {
    return calls_.serve(number, arguments);
  }
  void device_command(unsigned device, unsigned command, std::uint64_t payload) override;

 private:
  using Block = std::array<std::uint32_t, 4>;

  template <std::size_t Count>
  std::optional<Block> words_at(std::uint32_t address) const;
  HostReply answer(long result);
  HostReply open(const Block& block);
  HostReply write_text(std::uint32_t address);
  HostReply command_line(std::uint32_t block_address);

  Soc& soc_;
  HostFiles& files_;
  SystemCalls calls_;
  std::string program_;
  int errno_ = 0;  // error number of the last operation that failed
};

}  // namespace mebots::soc::tool
