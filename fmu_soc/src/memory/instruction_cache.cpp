// SPDX-License-Identifier: Apache-2.0
#include "memory/instruction_cache.hpp"

#include "mebots/assert.hpp"
#include "memory/memory.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <numeric>
#include <vector>

namespace mebots::soc {
namespace {

/// Minimum size of the array of presence bytes. The allocator maps arrays of this size near the bytes of a large
/// memory. Translated code can then address them with one instruction less, relative to the memory.
constexpr std::size_t kLeastPresenceBytes = std::size_t{256} << 10;

/// The values of the shift register after each number of shifts, from 0 on. The register shifts to the left, and sets
/// bit 0 if an even number of the bits 7, 3, 2 and 1 is set.
constexpr auto kShifted = [] {
  constexpr unsigned kTaps = 0x8e;
  std::array<std::uint8_t, InstructionCache::kShiftPeriod> values{};
  for (std::size_t i = 1; i < values.size(); ++i) {
    const unsigned last = values[i - 1];
    const auto even = static_cast<unsigned>(~std::popcount(last & kTaps) & 1);
    values[i] = static_cast<std::uint8_t>(last << 1 | even);
  }
  return values;
}();
static_assert(kShifted.back() == 0x80, "after all values, the register is 0 again");

}  // namespace

InstructionCache::InstructionCache(const InstructionCacheSettings& settings, Users users)
    : line_bits_(static_cast<unsigned>(std::countr_zero(settings.line))),
      ways_(settings.ways),
      set_mask_(settings.size / settings.line / settings.ways - 1),
      refill_cycles_(settings.refill_cycles),
      invalid_ways_first_(settings.invalid_ways_first),
      entries_(settings.size / settings.line, kNone),
      arrivals_(users == Users::several ? entries_.size() : 0),
      is_alone_(users == Users::one) {
  MEBOTS_ASSERT(!settings.invalid_ways_first || users == Users::several,
                "translated code selects ways only by the shift register");
  for (std::size_t i = 0; i < state_.way_offsets.size(); ++i) {
    const auto way = kShifted[(i + 1) % kShiftPeriod] >> kWayBit & (ways_ - 1);
    state_.way_offsets[i] = static_cast<std::uint32_t>(std::size_t{way} * sets() * sizeof(std::uint32_t));
  }
}

std::uint8_t InstructionCache::shift_register() const {
  return kShifted[state_.shifts];
}

void InstructionCache::cover(const Memory& memory) {
  note_absent();
  for (auto& entry : entries_) entry = kNone;
  memories_.clear();
  covered_count_ = 0;
  // A block may continue in the next memory, so lines are numbered in the order of addresses.
  std::vector<const Region*> regions;
  for (const auto& region : memory.regions()) regions.push_back(&region);
  std::sort(regions.begin(), regions.end(), [](const auto* one, const auto* other) { return one->base < other->base; });
  std::uint32_t number = kNone + 1;
  for (const auto* const region : regions) {
    const auto first_line = line_of(region->base);
    if (!memories_.empty() && first_line < memories_.back().first_line + memories_.back().count) {
      throw Error(
          fmt::format("memories {} and {} share a line of {} bytes of an instruction cache; align both memories to "
                      "the size of a line",
                      regions[memories_.size() - 1]->name, region->name, 4 * words_per_line()));
    }
    Covered covered;
    covered.base = region->base;
    covered.size = region->size;
    covered.first_line = first_line;
    covered.count = line_of(region->base + (region->size - 1)) - first_line + 1;
    covered.first_number = number;
    number += covered.count;
    memories_.push_back(covered);
  }
  // Translated code reads the presence bytes of a whole group of lines at once. Therefore the array has kMostGrouped
  // further bytes.
  const std::size_t count = number + kMostGrouped;
  present_ = std::make_unique_for_overwrite<std::uint8_t[]>(std::max(count, kLeastPresenceBytes));
  std::fill_n(present_.get(), count, std::uint8_t{0});
}

const std::uint8_t* InstructionCache::presence(std::uint32_t address) const {
  for (const auto& memory : memories_) {
    if (address - memory.base < memory.size)
      return &present_[memory.first_number + (line_of(address) - memory.first_line)];
  }
  return nullptr;
}

std::uint32_t InstructionCache::number_elsewhere(std::uint32_t line) const {
  if (memories_.empty()) return kNotCovered | line;
  for (const auto& memory : memories_) {
    if (line - memory.first_line >= memory.count) continue;
    covered_first_ = memory.first_line;
    covered_count_ = memory.count;
    covered_number_ = memory.first_number;
    return memory.first_number + (line - memory.first_line);
  }
  return kNone;
}

std::uint32_t InstructionCache::line_with(std::uint32_t number) const {
  if (number >= kNotCovered) return number & ~kNotCovered;
  for (const auto& memory : memories_) {
    if (number - memory.first_number < memory.count) return memory.first_line + (number - memory.first_number);
  }
  return kNoLine;
}

void InstructionCache::note_absent() {
  for (const auto entry : entries_) set_present(entry, 0);
}

void InstructionCache::note_present() {
  for (const auto entry : entries_) set_present(entry, 1);
}

void InstructionCache::note_arrivals(std::uint64_t tick) {
  std::erase_if(pending_refills_, [&](std::size_t place) {
    if (arrivals_[place] > tick) return false;
    set_present(entries_[place], 1);
    return true;
  });
}

void InstructionCache::set_alone(bool alone) {
  MEBOTS_ASSERT(is_shared());
  is_alone_ = alone;
  for (const auto place : pending_refills_)
    set_present(entries_[place], 0);  // a core that wakes up has not waited for these lines
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

std::uint32_t InstructionCache::undo_refills(std::uint32_t lines) {
  MEBOTS_ASSERT(!is_shared() && (lines & ~state_.group_refilled) == 0);
  const auto first_set = line_with(state_.group) & set_mask_;
  auto shifts = state_.group_shifts;
  for (auto left = state_.group_refilled; left != 0; left &= left - 1, ++shifts) {
    const auto i = static_cast<std::uint32_t>(std::countr_zero(left));
    if ((lines >> i & 1U) == 0) continue;
    auto& entry = entries_[state_.way_offsets[shifts] / sizeof(std::uint32_t) + first_set + i];
    MEBOTS_ASSERT(entry == state_.group + i, "each line of a group is in another set");
    set_present(entry, 0);
    entry = state_.group_evicted[i];
    set_present(entry, 1);
  }
  state_.group_refilled &= ~lines;
  const auto undone = static_cast<std::uint32_t>(std::popcount(lines));
  state_.refills -= undone;
  state_.shifts = (state_.shifts + kShiftPeriod - undone) % kShiftPeriod;
  return undone;
}

void InstructionCache::flush() {
  note_absent();
  std::fill(entries_.begin(), entries_.end(), kNone);
  std::fill(arrivals_.begin(), arrivals_.end(), 0);
  pending_refills_.clear();
}

void InstructionCache::visit(state::Visitor& v) {
  // In a saved state, entries are sorted by set, then by way.
  std::vector<Entry> entries(entries_.size());
  std::vector<std::uint64_t> arrivals(arrivals_.size());
  const auto place_of = [this](std::size_t i) { return i % ways_ * sets() + i / ways_; };
  for (std::size_t i = 0; i < entries.size(); ++i) entries[i].line = line_with(entries_[place_of(i)]);
  for (std::size_t i = 0; i < arrivals.size(); ++i) arrivals[i] = arrivals_[place_of(i)];
  auto register_value = shift_register();
  v("entries", std::span(entries));
  v("arrivals", std::span(arrivals));
  v("shift_register", register_value);
  v("refills", state_.refills);
  if (!v.restores()) return;
  const auto* value = std::find(kShifted.begin(), kShifted.end(), register_value);
  if (value == kShifted.end())
    throw Error(fmt::format("the state has {} in the shift register of an instruction cache", register_value));
  state_.shifts = static_cast<std::uint32_t>(value - kShifted.begin());
  note_absent();
  for (std::size_t i = 0; i < entries.size(); ++i) {
    entries_[place_of(i)] = entries[i].line == kNoLine ? kNone : number_of(entries[i].line);
  }
  note_present();
  for (std::size_t i = 0; i < arrivals.size(); ++i) arrivals_[place_of(i)] = arrivals[i];
  if (!is_shared()) return;
  pending_refills_.resize(entries_.size());  // lists all lines, because it is not known here which have arrived
  std::iota(pending_refills_.begin(), pending_refills_.end(), std::size_t{0});
  set_alone(is_alone_);
}

std::unique_ptr<InstructionCache> make_instruction_cache(const InstructionCacheSettings& settings,
                                                         InstructionCache::Users users) {
  return settings.size == 0 ? nullptr : std::make_unique<InstructionCache>(settings, users);
}

}  // namespace mebots::soc
