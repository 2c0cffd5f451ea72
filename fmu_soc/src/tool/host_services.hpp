// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "soc/program_host.hpp"
#include "soc/soc.hpp"
#include "tool/host_files.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <string>

namespace mebots::soc::tool {

/// Serves a program that runs alone: console, files, simulated time and exit, through semihosting or system calls.
class HostServices final : public HostCalls {
 public:
  HostServices(Soc& soc, HostFiles& files, std::string program)
      : soc_(soc), files_(files), program_(std::move(program)) {}

  HostReply semihosting(std::uint32_t operation, std::uint32_t parameter) override;
  HostReply system_call(std::uint32_t number, std::span<const std::uint32_t> arguments) override;
  void device_command(unsigned device, unsigned command, std::uint64_t payload) override;

 private:
  using Block = std::array<std::uint32_t, 4>;

  template <std::size_t Count>
  std::optional<Block> words_at(std::uint32_t address) const;
  std::optional<std::string> text_at(std::uint32_t address, std::uint32_t length) const;
  std::optional<std::string> text_at(std::uint32_t address) const;
  void report_once(const std::string& request);
  HostReply answer(long result);
  HostReply open(const Block& block);
  long transfer(bool is_read, int file, std::uint32_t address, std::uint32_t count);
  HostReply write_text(std::uint32_t address);
  HostReply command_line(std::uint32_t block_address);
  std::uint64_t time_in(std::uint64_t per_second) const;

  Soc& soc_;
  HostFiles& files_;
  std::string program_;
  std::set<std::string> reported_;  // unknown requests that have been reported
  int errno_ = 0;                   // of the last operation that failed
};

}  // namespace mebots::soc::tool
