// SPDX-License-Identifier: Apache-2.0
#include "memory/instruction_cache.hpp"

#include "mebots/assert.hpp"
#include "memory/memory.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <numeric>

namespace mebots::soc {
namespace {

/// Minimum size of the array of presence bytes. The allocator maps arrays of this size near the bytes of a large
/// memory. Translated code can then address them with one instruction less, relative to the memory.
constexpr std::size_t kLeastPresenceBytes = std::size_t{256} << 10;

/// Shifts to the left, and sets bit 0 if an even number of the bits 7, 3, 2 and 1 is set.
constexpr auto kNextShift = [] {
  constexpr unsigned kTaps = 0x8e;
  std::array<std::uint8_t, 256> next{};
  for (unsigned value = 0; value < next.size(); ++value) {
    const auto even = static_cast<unsigned>(~std::popcount(value & kTaps) & 1);
    next[value] = static_cast<std::uint8_t>(value << 1 | even);
  }
  return next;
}();

}  // namespace

InstructionCache::InstructionCache(const InstructionCacheSettings& settings, Users users)
    : line_bits_(static_cast<unsigned>(std::countr_zero(settings.line))),
      ways_(settings.ways),
      set_mask_(settings.size / settings.line / settings.ways - 1),
      refill_cycles_(settings.refill_cycles),
      invalid_ways_first_(settings.invalid_ways_first),
      entries_(settings.size / settings.line, Entry{&nowhere_, kNoLine}),
      arrivals_(users == Users::several ? entries_.size() : 0),
      is_alone_(users == Users::one) {
  MEBOTS_ASSERT(!settings.invalid_ways_first || users == Users::several, "translated code asks the register alone");
  state_.entries = entries_.data();
  state_.next_shift = kNextShift;
}

void InstructionCache::cover(const Memory& memory) {
  presence_.clear();
  covered_count_ = 0;
  for (const auto& region : memory.regions()) {
    for (const auto& other : memory.regions()) {
      if (&other != &region && line_of(other.base) <= line_of(region.base + (region.size - 1)) &&
          line_of(other.base + (other.size - 1)) >= line_of(region.base)) {
        throw Error(
            fmt::format("memories {} and {} share a line of {} bytes of an instruction cache; align both memories to "
                        "the size of a line",
                        region.name, other.name, 4 * words_per_line()));
      }
    }
    Presence presence;
    presence.base = region.base;
    presence.size = region.size;
    presence.first_line = line_of(region.base);
    presence.count = line_of(region.base + (region.size - 1)) - presence.first_line + 1;
    presence.bytes =
        std::make_unique_for_overwrite<std::uint8_t[]>(std::max<std::size_t>(presence.count, kLeastPresenceBytes));
    std::fill_n(presence.bytes.get(), presence.count, std::uint8_t{0});
    presence_.push_back(std::move(presence));
  }
  note_present();
}

const std::uint8_t* InstructionCache::presence(std::uint32_t address) const {
  for (const auto& presence : presence_) {
    if (address - presence.base < presence.size) return &presence.bytes[line_of(address) - presence.first_line];
  }
  return nullptr;
}

void InstructionCache::cover_line(std::uint32_t line) {
  for (const auto& presence : presence_) {
    if (line - presence.first_line >= presence.count) continue;
    covered_ = presence.bytes.get();
    covered_first_ = presence.first_line;
    covered_count_ = presence.count;
    return;
  }
}

void InstructionCache::note_absent() {
  for (auto& entry : entries_) {
    *entry.present = 0;
    entry.present = &nowhere_;
  }
}

void InstructionCache::note_present() {
  for (auto& entry : entries_) {
    if (entry.line == kNoLine) continue;
    entry.present = byte_of(entry.line);
    *entry.present = 1;
  }
}

void InstructionCache::note_arrivals(std::uint64_t tick) {
  std::erase_if(pending_refills_, [&](std::size_t place) {
    if (arrivals_[place] > tick) return false;
    *entries_[place].present = 1;
    return true;
  });
}

void InstructionCache::set_alone(bool alone) {
  MEBOTS_ASSERT(is_shared());
  is_alone_ = alone;
  for (const auto place : pending_refills_)
    *entries_[place].present = 0;  // a core that wakes up has not waited for these lines
}

std::uint32_t InstructionCache::fetch(std::uint32_t line, std::uint64_t tick) {
  if (const auto* entry = find(line); entry != nullptr) {
    if (!is_shared()) return 0;
    // Another core has started the refill of this line, perhaps in a later tick. This core waits no longer than for a
    // refill that it starts itself.
    const auto arrival = arrivals_[static_cast<std::size_t>(entry - entries_.data())];
    const auto wait = arrival > tick ? arrival - tick : 0;
    return static_cast<std::uint32_t>(std::min<std::uint64_t>(wait, refill_cycles_));
  }
  return refill(line, tick);
}

void InstructionCache::flush() {
  note_absent();
  for (auto& entry : entries_) entry.line = kNoLine;
  std::fill(arrivals_.begin(), arrivals_.end(), 0);
  pending_refills_.clear();
}

void InstructionCache::visit(state::Visitor& v) {
  if (v.restores()) note_absent();
  v("entries", std::span(entries_));
  if (v.restores()) note_present();
  v("arrivals", std::span(arrivals_));
  v("shift_register", state_.shift_register);
  v("refills", state_.refills);
  if (!v.restores() || !is_shared()) return;
  pending_refills_.resize(entries_.size());  // lists all entries, because it is unknown which lines have arrived
  std::iota(pending_refills_.begin(), pending_refills_.end(), std::size_t{0});
  set_alone(is_alone_);
}

std::unique_ptr<InstructionCache> make_instruction_cache(const InstructionCacheSettings& settings,
                                                         InstructionCache::Users users) {
  return settings.size == 0 ? nullptr : std::make_unique<InstructionCache>(settings, users);
}

}  // namespace mebots::soc
