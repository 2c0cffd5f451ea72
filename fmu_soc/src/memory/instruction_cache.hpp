// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/assert.hpp"
#include "mebots/state/visitor.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace mebots::soc {

class Memory;

/// Shape and timing of an instruction cache. All sizes and the number of ways are powers of two.
struct InstructionCacheSettings {
  std::uint32_t size = 0;  // bytes; 0 = no cache
  std::uint32_t line = 16;
  std::uint32_t ways = 4;
  std::uint32_t refill_cycles = 0;      // cycles from a miss until the core has its instruction
  std::uint32_t refill_soc_cycles = 0;  // cluster only: additional cycles of the SoC's clock
  bool invalid_ways_first = false;      // cluster only: if true, a refill prefers an invalid way
};

/// Models which lines a cache contains. Does not store instructions, which are always read from memory.
///
/// A hit changes no state, as in the chip. An 8-bit shift register selects the way for a refill and advances with every
/// refill (source: GVSoC, models/cache, which assigns it to GAP's fabric controller). A cluster's cache may prefer
/// invalid ways, as in pulp-platform/icache_mp_128_pf (icache_bank_mp_128.sv). The shift register then only advances if
/// all ways of the set are valid.
///
/// If several cores share the cache, a core may need a line whose refill another core has started. Such a line does not
/// count as present until settle() is called for a tick at or after its arrival. Until then, cores must call fetch()
/// for this line.
class InstructionCache {
 public:
  enum class Users : std::uint8_t { one, several };

  explicit InstructionCache(const InstructionCacheSettings& settings, Users users = Users::one);
  InstructionCache(const InstructionCache&) = delete;
  InstructionCache& operator=(const InstructionCache&) = delete;

  /// Prepares the cache for all regions of the memory. Throws Error if two regions share a line.
  void cover(const Memory& memory);

  std::uint32_t line_of(std::uint32_t address) const { return address >> line_bits_; }
  std::uint32_t address_of(std::uint32_t line) const { return line << line_bits_; }
  std::uint32_t words_per_line() const { return 1U << (line_bits_ - 2); }
  std::uint32_t refill_cycles() const { return refill_cycles_; }
  /// Sets the number of cycles of later refills. The cache must be shared, because translated code contains this number
  /// as a constant for other caches.
  void set_refill_cycles(std::uint32_t cycles) {
    MEBOTS_ASSERT(is_shared());
    refill_cycles_ = cycles;
  }
  std::uint32_t ways() const { return ways_; }

  bool is_shared() const { return !arrivals_.empty(); }

  /// Returns true if the cache contains the line or is fetching it.
  bool holds(std::uint32_t line) const { return find(line) != nullptr; }
  /// Returns true if the cache contains the line, and the line has arrived for all cores.
  bool has_arrived(std::uint32_t line) const {
    const auto* entry = find(line);
    return entry != nullptr && *entry->present != 0;
  }
  /// Returns the presence byte of the line that contains this address, or null if no covered memory contains the
  /// address. The byte is 1 if the line has arrived. The presence bytes of the next lines of the same memory follow
  /// this byte.
  const std::uint8_t* presence(std::uint32_t address) const;
  /// Fetches the line if it is absent. Returns the number of cycles that a fetch in cycle `tick` waits.
  std::uint32_t fetch(std::uint32_t line, std::uint64_t tick);
  /// Fetches an absent line. Returns the number of cycles that the fetch waits.
  std::uint32_t refill(std::uint32_t line, std::uint64_t tick) {
    const auto place = (line & set_mask_) * ways_ + way_for(line);
    auto& entry = entries_[place];
    *entry.present = 0;
    entry.present = byte_of(line);
    entry.line = line;
    *entry.present = is_alone_ ? 1 : 0;
    ++state_.refills;
    if (is_shared()) {
      arrivals_[place] = tick + refill_cycles_;
      pending_refills_.push_back(place);
    }
    return refill_cycles_;
  }
  /// Only for a shared cache. Marks all lines that arrive at or before `tick` as present. Afterwards, no core may
  /// access the cache in an earlier tick.
  void settle(std::uint64_t tick) {
    if (!pending_refills_.empty()) [[unlikely]]
      note_arrivals(tick);
  }
  /// Only for a shared cache. `alone` must only be true if no other core can need a line before the line has arrived
  /// for the core that fetches it.
  void set_alone(bool alone);
  void flush();
  std::uint64_t refills() const { return state_.refills; }

  void visit(state::Visitor& v);

  /// Marks an empty entry; the last line of the address space contains no code.
  static constexpr std::uint32_t kNoLine = ~std::uint32_t{0};

  struct Entry {
    std::uint8_t* present = nullptr;  // presence byte of `line`; follows from `line`
    std::uint32_t line = kNoLine;

    void visit(state::Visitor& v) { v("line", line); }
  };

  /// Data that a refill changes. Translated code accesses them if the cache has one user.
  struct State {
    Entry* entries = nullptr;  // sorted by set, then by way
    std::uint64_t refills = 0;
    std::uint8_t shift_register = 0;
    std::array<std::uint8_t, 256> next_shift{};  // next value of the shift register, for each value
  };
  /// After the shift register has advanced, the number of the way to refill starts at this bit.
  static constexpr unsigned kWayBit = 1;
  const State& state() const { return state_; }
  /// Returns the byte offset of the first entry in the set of a line.
  std::uint32_t first_of_set(std::uint32_t line) const {
    return (line & set_mask_) * ways_ * static_cast<std::uint32_t>(sizeof(Entry));
  }

 private:
  const Entry* find(std::uint32_t line) const {
    const auto* set = &entries_[std::size_t{line & set_mask_} * ways_];
    for (std::uint32_t way = 0; way < ways_; ++way) {
      if (set[way].line == line) return &set[way];
    }
    return nullptr;
  }
  struct Presence {
    std::uint32_t base = 0;
    std::uint32_t size = 0;
    std::uint32_t first_line = 0;
    std::uint32_t count = 0;
    std::unique_ptr<std::uint8_t[]> bytes;
  };

  std::uint32_t way_for(std::uint32_t line) {
    if (!invalid_ways_first_) return next_way();
    const auto* set = &entries_[std::size_t{line & set_mask_} * ways_];
    for (std::uint32_t way = 0; way < ways_; ++way) {
      if (set[way].line == kNoLine) return way;
    }
    return next_way();
  }
  std::uint32_t next_way() {
    state_.shift_register = state_.next_shift[state_.shift_register];
    return (state_.shift_register >> kWayBit) & (ways_ - 1);
  }
  /// Returns the presence byte of a line, or a dummy byte if no covered memory contains the line.
  std::uint8_t* byte_of(std::uint32_t line) {
    if (line - covered_first_ >= covered_count_) cover_line(line);
    return line - covered_first_ < covered_count_ ? &covered_[line - covered_first_] : &nowhere_;
  }
  void cover_line(std::uint32_t line);
  void note_absent();
  void note_present();
  void note_arrivals(std::uint64_t tick);

  unsigned line_bits_;
  std::uint32_t ways_;
  std::uint32_t set_mask_;
  std::uint32_t refill_cycles_;
  bool invalid_ways_first_;
  std::vector<Entry> entries_;
  /// Tick in which the line of each entry arrives; empty if the cache has one user.
  std::vector<std::uint64_t> arrivals_;
  State state_;
  // Presence bytes of each memory, and the memory that was found last. Not part of a state, because they can be
  // computed from the entries.
  std::vector<Presence> presence_;
  std::uint8_t* covered_ = nullptr;
  std::uint32_t covered_first_ = 0;
  std::uint32_t covered_count_ = 0;
  std::uint8_t nowhere_ = 0;
  // Only for a shared cache: indices of the entries whose lines may not have arrived for all cores. May also contain
  // entries whose lines have arrived. Not part of a state.
  std::vector<std::size_t> pending_refills_;
  bool is_alone_;  // last argument of set_alone()
};

/// Returns the cache that the settings describe, or null if they describe none.
std::unique_ptr<InstructionCache> make_instruction_cache(const InstructionCacheSettings& settings,
                                                         InstructionCache::Users users);

}  // namespace mebots::soc
