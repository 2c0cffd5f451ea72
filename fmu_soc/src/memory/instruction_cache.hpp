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

  bool is_shared() const { return !arrivals_.empty(); }
  /// Returns the number of consecutive lines, from this one on, up to the line in the last set.
  std::uint32_t lines_before_first_set(std::uint32_t line) const { return set_mask_ + 1 - (line & set_mask_); }

  /// Returns true if the cache contains the line or is fetching it.
  bool holds(std::uint32_t line) const { return find(line) != nullptr; }
  /// Returns true if the cache contains the line, and the line has arrived for all cores.
  bool has_arrived(std::uint32_t line) const {
    const auto number = number_of(line);
    return is_covered(number) && present_[number] != 0;
  }
  /// Returns the presence byte of the line that contains this address. Returns null if cover() was called for no memory
  /// that contains the address. The byte is 1 if the line has arrived. The presence bytes of the next lines follow this
  /// byte, also those of the next memory if it begins where this one ends.
  const std::uint8_t* presence(std::uint32_t address) const;
  /// Fetches the line if it is absent. Returns the number of cycles that a fetch in cycle `tick` waits.
  std::uint32_t fetch(std::uint32_t line, std::uint64_t tick);
  /// Fetches an absent line. Returns the number of cycles that the fetch waits.
  std::uint32_t refill(std::uint32_t line, std::uint64_t tick) {
    const auto place = place_for(line);
    auto& entry = entries_[place];
    set_present(entry, 0);
    entry = number_of(line);
    set_present(entry, is_alone_ ? 1 : 0);
    ++state_.refills;
    if (is_shared()) {
      arrivals_[place] = tick + refill_cycles_;
      pending_refills_.push_back(place);
    }
    return refill_cycles_;
  }
  /// Undoes refills of the group of lines that translated code has fetched last. If bit i of `lines` is set, undoes the
  /// refill of the group's line i, which must have been refilled. Refills of later lines must be undone, too. Returns
  /// the number of refills that were undone.
  std::uint32_t undo_refills(std::uint32_t lines);
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

  static constexpr std::uint32_t kNoLine = ~std::uint32_t{0};  // marks an empty entry in a saved state
  /// Maximum number of lines that translated code fetches together.
  static constexpr std::uint32_t kMostGrouped = 16;
  /// Number of refills after which the values of the shift register repeat.
  static constexpr std::uint32_t kShiftPeriod = 255;

  /// Data that a refill changes. Translated code accesses them if the cache has one user. Lines of memories have
  /// numbers from 1 on. Consecutive lines have consecutive numbers, also if the second line is in the next memory.
  struct State {
    std::uint64_t refills = 0;
    std::uint32_t shifts = 0;  // number of shifts of the shift register, modulo kShiftPeriod
    /// Indexed by `shifts`: the offset [bytes] from an entry in way 0 to the entry in the way that the next refill
    /// replaces. The array repeats its first values at the end, so that the offsets of a group's refills are
    /// consecutive.
    std::array<std::uint32_t, kShiftPeriod + kMostGrouped> way_offsets{};
    // The group of lines that translated code has refilled last. Bit i belongs to line i of the group.
    std::uint64_t group_when = 0;                             // the counts in xmm15 at that time
    std::uint32_t group = 0;                                  // number of its first line
    std::uint32_t group_refilled = 0;                         // bits of the lines that were absent
    std::uint32_t group_shifts = 0;                           // `shifts` before the group
    std::array<std::uint32_t, kMostGrouped> group_evicted{};  // numbers of the lines that were replaced
  };
  const State& state() const { return state_; }
  std::uint8_t shift_register() const;
  /// Returns the number of a line, or kNone if no memory contains the line.
  std::uint32_t number_of(std::uint32_t line) const {
    if (line - covered_first_ >= covered_count_) return number_elsewhere(line);
    return covered_number_ + (line - covered_first_);
  }
  /// Returns the presence bytes, indexed by the number of the line.
  const std::uint8_t* presence_by_number() const { return present_.get(); }
  /// Returns the entry of way 0 in the set of a line. An entry is the number of the line that is in this way.
  const std::uint32_t* first_entry(std::uint32_t line) const { return &entries_[line & set_mask_]; }

 private:
  static constexpr std::uint32_t kNone = 0;  // in place of a line's number: no line; its presence byte has no meaning
  /// Bit that is set in the number of each line as long as cover() was not called.
  static constexpr std::uint32_t kNotCovered = 1U << 31;
  /// The way to refill is in consecutive bits of the shift register. This is the number of the lowest of them.
  static constexpr unsigned kWayBit = 1;

  /// An entry in a saved state.
  struct Entry {
    std::uint32_t line = kNoLine;

    void visit(state::Visitor& v) { v("line", line); }
  };
  /// Describes the lines of one memory.
  struct Covered {
    std::uint32_t base = 0;
    std::uint32_t size = 0;
    std::uint32_t first_line = 0;
    std::uint32_t count = 0;
    std::uint32_t first_number = 0;
  };

  static bool is_covered(std::uint32_t number) { return number != kNone && number < kNotCovered; }
  void set_present(std::uint32_t number, std::uint8_t present) {
    if (is_covered(number)) present_[number] = present;
  }
  std::uint32_t sets() const { return set_mask_ + 1; }
  const std::uint32_t* find(std::uint32_t line) const {
    const auto number = number_of(line);
    if (number == kNone) return nullptr;
    const auto* entry = first_entry(line);
    for (std::uint32_t way = 0; way < ways_; ++way, entry += sets()) {
      if (*entry == number) return entry;
    }
    return nullptr;
  }
  /// Returns the index of the entry that a refill of this line replaces.
  std::size_t place_for(std::uint32_t line) {
    const auto set = line & set_mask_;
    for (std::uint32_t way = 0; invalid_ways_first_ && way < ways_; ++way) {
      if (entries_[way * sets() + set] == kNone) return way * sets() + set;
    }
    const auto offset = state_.way_offsets[state_.shifts];
    state_.shifts = state_.shifts + 1 == kShiftPeriod ? 0 : state_.shifts + 1;
    return offset / sizeof(std::uint32_t) + set;
  }
  std::uint32_t number_elsewhere(std::uint32_t line) const;
  std::uint32_t line_with(std::uint32_t number) const;
  void note_absent();
  void note_present();
  void note_arrivals(std::uint64_t tick);

  unsigned line_bits_;
  std::uint32_t ways_;
  std::uint32_t set_mask_;
  std::uint32_t refill_cycles_;
  bool invalid_ways_first_;
  std::vector<std::uint32_t> entries_;   // numbers of lines, sorted by way, then by set
  std::vector<std::uint64_t> arrivals_;  // tick in which each line arrives; empty if the cache has one user
  State state_;
  // These members are not part of a saved state. They are the covered memories, the memory that was found last, and the
  // presence byte of each line, which follows from the entries.
  std::vector<Covered> memories_;
  mutable std::uint32_t covered_first_ = 0;
  mutable std::uint32_t covered_count_ = 0;
  mutable std::uint32_t covered_number_ = 0;
  std::unique_ptr<std::uint8_t[]> present_;
  // Only for a shared cache: indices of entries whose lines may not have arrived for all cores. The list may also
  // contain entries whose lines have arrived. Not part of a saved state.
  std::vector<std::size_t> pending_refills_;
  bool is_alone_;  // last argument of set_alone()
};

/// Returns the cache that the settings describe, or null if they describe none.
std::unique_ptr<InstructionCache> make_instruction_cache(const InstructionCacheSettings& settings,
                                                         InstructionCache::Users users);

}  // namespace mebots::soc
