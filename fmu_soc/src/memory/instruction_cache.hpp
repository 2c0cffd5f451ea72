// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/bytes.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace mebots::soc {

/// Shape and cost of an instruction cache; from the board. Bytes and ways are powers of two.
struct InstructionCacheSettings {
  std::uint32_t size = 0;  // bytes; 0 = there is none
  std::uint32_t line = 16;
  std::uint32_t ways = 4;
  std::uint32_t refill_cycles = 0;  // from the miss until the core has its instruction
};

/// Which lines of code a cache holds. Only presence matters: the instructions themselves are always those of the
/// memory.
///
/// A hit changes nothing, as in the chip: the way that a refill takes comes from an 8-bit shift register that moves
/// with every refill. (Source: GVSoC, models/cache, which names it as that of GAP's fabric controller.) So who knows
/// that all lines of a piece of code are here need not ask again until one of them has left.
class InstructionCache {
 public:
  static constexpr std::uint32_t kNoLine = ~std::uint32_t{0};  // the number of no line: the last one holds no code

  explicit InstructionCache(const InstructionCacheSettings& settings);

  std::uint32_t line_of(std::uint32_t address) const { return address >> line_bits_; }
  std::uint32_t address_of(std::uint32_t line) const { return line << line_bits_; }
  std::uint32_t words_per_line() const { return 1U << (line_bits_ - 2); }
  std::uint32_t refill_cycles() const { return refill_cycles_; }

  bool holds(std::uint32_t line) const { return find(line) != nullptr; }
  /// Cycles that a fetch from this line in cycle `tick` waits; brings it here when it is not.
  std::uint32_t fetch(std::uint32_t line, std::uint64_t tick);
  /// The line that had to go in the last refill, kNoLine when none had.
  std::uint32_t evicted() const { return evicted_; }
  /// All lines have arrived from this tick on.
  std::uint64_t settled() const { return settled_; }
  /// Empties it.
  void flush();
  /// Lines fetched from memory since reset of the chip.
  std::uint64_t refills() const { return refills_; }

  void save(state::Writer& writer) const;
  void restore(state::Reader& reader);

 private:
  struct Entry {
    std::uint32_t line = kNoLine;
    std::uint32_t unused = 0;  // no padding: equal states are equal bytes
    std::uint64_t ready = 0;   // the tick in which it has arrived
  };

  const Entry* find(std::uint32_t line) const {
    const auto* set = &entries_[std::size_t{line & set_mask_} * ways_];
    for (std::uint32_t way = 0; way < ways_; ++way) {
      if (set[way].line == line) return &set[way];
    }
    return nullptr;
  }
  std::uint32_t next_way();

  unsigned line_bits_;
  std::uint32_t ways_;
  std::uint32_t set_mask_;
  std::uint32_t refill_cycles_;
  std::vector<Entry> entries_;  // by set, then way
  std::uint8_t shift_register_ = 0;
  std::uint32_t evicted_ = kNoLine;
  std::uint64_t settled_ = 0;
  std::uint64_t refills_ = 0;
};

}  // namespace mebots::soc
