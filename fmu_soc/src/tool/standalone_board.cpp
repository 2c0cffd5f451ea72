// SPDX-License-Identifier: Apache-2.0
#include "tool/standalone_board.hpp"

#include "mebots/error.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdint>
#include <limits>

namespace mebots::soc::tool {
namespace {

constexpr std::uint64_t kPage = 4096;
constexpr std::uint64_t kMiB = 1U << 20;
constexpr std::uint64_t kMost = 2048 * kMiB;

}  // namespace

BoardDescription board_around(const Elf& program) {
  std::uint64_t lowest = std::numeric_limits<std::uint32_t>::max();
  std::uint64_t highest = 0;
  for (const auto& segment : program.segments()) {
    lowest = std::min<std::uint64_t>(lowest, segment.address);
    highest = std::max<std::uint64_t>(highest, std::uint64_t{segment.address} + segment.size);
  }
  const auto base = lowest / kPage * kPage;
  auto end = std::max(base + 4 * kMiB, (highest + kMiB + kPage - 1) / kPage * kPage);
  end = std::min<std::uint64_t>(end, std::uint64_t{1} << 32);
  if (end - base > kMost) {
    throw Error(fmt::format("{}: its segments span {} MiB, more than {}: name a board", program.origin(),
                            (end - base) / kMiB, kMost / kMiB));
  }
  BoardDescription board;
  board.name = "none";
  BoardMemory ram;
  ram.name = "ram";
  ram.base = static_cast<std::uint32_t>(base);
  ram.size = static_cast<std::uint32_t>(end - base);
  ram.leaks = false;  // it is nobody's chip
  board.memories.push_back(ram);
  return board;
}

}  // namespace mebots::soc::tool
