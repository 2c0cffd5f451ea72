// SPDX-License-Identifier: Apache-2.0
#include "soc/backtrace.hpp"

#include "hart/block_cache.hpp"
#include "isa/encoding.hpp"

#include <fmt/core.h>

#include <vector>

namespace mebots::soc::debug {
namespace {

constexpr std::size_t kMostFrames = 8;
constexpr std::uint32_t kMostWords = 2048;
/// If a stack pointer is at most this distance below a memory, it counts as a stack overflow of that memory.
constexpr std::uint32_t kOverrun = 1U << 16;

struct Frame {
  std::uint32_t address = 0;
  unsigned times = 1;
};

bool is_call(const Memory& memory, std::uint32_t address, unsigned length) {
  std::uint32_t word = 0;
  std::uint32_t fault_address = 0;
  if (!BlockCache::fetch(memory, address, word, fault_address)) return false;
  const auto decoded = decode(word);
  return is_jump(decoded.op) && decoded.length == length && (decoded.rd == 1 || decoded.rd == 5);
}

bool is_return_address(const Memory& memory, std::uint32_t address) {
  return address % 2 == 0 && (is_call(memory, address - 4, 4) || is_call(memory, address - 2, 2));
}

/// Returns the lowest address of the stack that is in memory.
std::uint32_t first_word(const Memory& memory, std::uint32_t pointer) {
  pointer = (pointer + 3) & ~3U;
  if (memory.find(pointer, 4) != nullptr) return pointer;
  for (const auto& region : memory.regions()) {
    if (pointer < region.base && region.base - pointer <= kOverrun) return region.base;
  }
  return pointer;
}

}  // namespace

std::string backtrace(const Elf& program, const Memory& memory, std::uint32_t return_address,
                      std::uint32_t stack_pointer) {
  std::vector<Frame> frames;
  const auto add = [&](std::uint32_t address) {
    if (!is_return_address(memory, address)) return;
    if (!frames.empty() && frames.back().address == address) {
      ++frames.back().times;
    } else if (frames.size() < kMostFrames) {
      frames.push_back({address, 1});
    }
  };
  add(return_address);
  auto at = first_word(memory, stack_pointer);
  for (std::uint32_t i = 0; i < kMostWords; ++i, at += 4) {
    std::uint32_t word = 0;
    if (!memory.read(at, {reinterpret_cast<std::uint8_t*>(&word), sizeof word})) break;
    add(word);
  }
  std::string text;
  for (const auto& frame : frames) {
    const auto name = program.where_called(frame.address);
    if (!text.empty()) text += " < ";
    text += name.empty() ? fmt::format("0x{:08x}", frame.address) : name;
    if (frame.times > 1) text += fmt::format(" ({} times)", frame.times);
  }
  return text;
}

}  // namespace mebots::soc::debug
