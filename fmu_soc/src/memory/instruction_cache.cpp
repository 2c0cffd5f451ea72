// SPDX-License-Identifier: Apache-2.0
#include "memory/instruction_cache.hpp"

#include "memory/memory.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <bit>

namespace mebots::soc {
namespace {

/// So large that the allocator maps it: it lies near the bytes of a large memory then, where translated code reaches it
/// by a short address. Elsewhere it costs an instruction more.
constexpr std::size_t kLeastPresenceBytes = std::size_t{256} << 10;

}  // namespace

InstructionCache::InstructionCache(const InstructionCacheSettings& settings)
    : line_bits_(static_cast<unsigned>(std::countr_zero(settings.line))),
      ways_(settings.ways),
      set_mask_(settings.size / settings.line / settings.ways - 1),
      refill_cycles_(settings.refill_cycles),
      entries_(settings.size / settings.line),
      present_(entries_.size(), &nowhere_) {
  state_.entries = entries_.data();
  state_.present = present_.data();
}

void InstructionCache::cover(const Memory& memory) {
  presence_.clear();
  covered_count_ = 0;
  for (const auto& region : memory.regions()) {
    for (const auto& other : memory.regions()) {
      if (&other != &region && line_of(other.base) <= line_of(region.base + (region.size - 1)) &&
          line_of(other.base + (other.size - 1)) >= line_of(region.base)) {
        throw Error(fmt::format("memories {} and {} share a line of {} bytes of an instruction cache; align them to it",
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
  for (auto& present : present_) {
    *present = 0;
    present = &nowhere_;
  }
}

void InstructionCache::note_present() {
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    if (entries_[i].line == kNoLine) continue;
    present_[i] = byte_of(entries_[i].line);
    *present_[i] = 1;
  }
}

std::uint32_t InstructionCache::fetch(std::uint32_t line, std::uint64_t tick) {
  if (const auto* entry = find(line); entry != nullptr) {
    // On its way for another core. One that is behind in time would have asked for it itself.
    const auto wait = entry->ready > tick ? entry->ready - tick : 0;
    return static_cast<std::uint32_t>(std::min<std::uint64_t>(wait, refill_cycles_));
  }
  return refill(line, tick);
}

void InstructionCache::flush() {
  note_absent();
  std::fill(entries_.begin(), entries_.end(), Entry{});
}

void InstructionCache::visit(state::Visitor& v) {
  if (v.restores()) note_absent();
  v("entries", std::span(entries_));
  if (v.restores()) note_present();
  v("shift_register", state_.shift_register);
  v("settled", state_.settled);
  v("refills", state_.refills);
}

}  // namespace mebots::soc
