// SPDX-License-Identifier: Apache-2.0
#include "tool/standalone_board.hpp"

#include "mebots/error.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

namespace mebots::soc::tool {
namespace {

constexpr std::uint64_t kPage = 4096;
constexpr std::uint64_t kMiB = 1U << 20;
/// Ranges that lie farther apart get a memory each: flash and RAM of a chip, with nothing between.
constexpr std::uint64_t kFar = 64 * kMiB;
constexpr std::uint64_t kMost = 2048 * kMiB;
constexpr std::uint64_t kAddressSpace = std::uint64_t{1} << 32;

struct Range {
  std::uint64_t begin = 0;
  std::uint64_t end = 0;
};

/// Address ranges of the program's segments: load addresses and run addresses.
std::vector<Range> ranges_of(const Elf& program) {
  std::vector<Range> ranges;
  for (const auto& segment : program.segments()) {
    const std::uint64_t load = segment.load_address;
    const std::uint64_t run = segment.run_address;
    if (!segment.bytes.empty()) ranges.push_back({load, load + segment.bytes.size()});
    ranges.push_back({run, run + segment.size});
  }
  std::ranges::sort(ranges, {}, &Range::begin);
  return ranges;
}

/// Ranges that are near each other as one.
std::vector<Range> merged(const std::vector<Range>& ranges) {
  std::vector<Range> groups;
  for (const auto& range : ranges) {
    if (groups.empty() || range.begin > groups.back().end + kFar) {
      groups.push_back(range);
    } else {
      groups.back().end = std::max(groups.back().end, range.end);
    }
  }
  return groups;
}

/// Rounds a range to pages and adds space after the program for its heap and stack.
Range with_room(const Range& range) {
  const auto begin = range.begin / kPage * kPage;
  const auto end = std::max(begin + 4 * kMiB, (range.end + kMiB + kPage - 1) / kPage * kPage);
  return {begin, std::min(end, kAddressSpace)};
}

}  // namespace

BoardDescription board_around(const Elf& program) {
  BoardDescription board;
  board.name = "none";
  std::uint64_t total = 0;
  for (const auto& group : merged(ranges_of(program))) {
    const auto range = with_room(group);
    BoardMemory ram;
    ram.name = fmt::format("ram{}", board.memories.empty() ? "" : std::to_string(board.memories.size() + 1));
    ram.base = static_cast<std::uint32_t>(range.begin);
    ram.size = static_cast<std::uint32_t>(std::min(range.end - range.begin, kMost));
    ram.leaks = false;  // it is nobody's chip
    board.memories.push_back(ram);
    total += range.end - range.begin;
  }
  if (total > kMost) {
    throw Error(fmt::format("{}: its segments take {} MiB, more than {}: name a board", program.origin(), total / kMiB,
                            kMost / kMiB));
  }
  return board;
}

}  // namespace mebots::soc::tool
