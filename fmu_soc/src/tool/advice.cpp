// SPDX-License-Identifier: Apache-2.0
#include "hart/csr_numbers.hpp"
#include "tool/run.hpp"
#include "tool/system_calls.hpp"

#include "mebots/error.hpp"

#include <fmt/core.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string>
#include <vector>

namespace mebots::soc::tool {
namespace {

constexpr unsigned kCallNumber = 17;  // a7

/// Returns the devices at an address on boards of this installation, such as "uart of board virt".
std::vector<std::string> devices_at(std::uint32_t address) {
  std::vector<std::string> found;
  for (const auto& path : own_boards()) {
    try {
      const auto board = read_board(path);
      for (const auto& device : board.devices) {
        if (device.is_on_bus() && address - device.base < device.size()) {
          found.push_back(fmt::format("{} of board {}", device.name, board.name));
        }
      }
    } catch (const Error&) {
      continue;  // ignores a board that cannot be read
    }
  }
  return found;
}

}  // namespace

std::string advice_after_fault(const Soc& soc, const Options& options) {
  if (soc.end() != End::faulted || !soc.hart().fault().happened) return {};
  const auto& first = soc.hart().fault().first;
  if (first.cause == cause::kMachineEcall && !options.user) {
    const auto number = soc.hart().reg(kCallNumber);
    const auto name = system_call_name(number);
    return fmt::format(
        "if this ecall is system call {}{} of an operating system: run the program with --user, which executes system "
        "calls",
        number, name.empty() ? "" : fmt::format(" ({})", name));
  }
  const bool is_access = first.cause == cause::kLoadAccess || first.cause == cause::kStoreAccess;
  if (!is_access || options.board) return {};
  const auto devices = devices_at(first.value);
  if (devices.empty()) {
    return fmt::format("if there is RAM at 0x{:08x}, add it: --ram 0x{:08x}:1M", first.value, first.value & ~0xfffffU);
  }
  return fmt::format("0x{:08x} is the {}: name it by --board", first.value, fmt::join(devices, ", the "));
}

}  // namespace mebots::soc::tool
