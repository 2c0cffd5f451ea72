// SPDX-License-Identifier: Apache-2.0
#include "memory/instruction_cache.hpp"

#include <algorithm>
#include <bit>

namespace mebots::soc {
namespace {

/// What the shift register feeds back: bits 7, 3, 2 and 1.
constexpr std::uint8_t kTaps = 0x8e;

}  // namespace

InstructionCache::InstructionCache(const InstructionCacheSettings& settings)
    : line_bits_(static_cast<unsigned>(std::countr_zero(settings.line))),
      ways_(settings.ways),
      set_mask_(settings.size / settings.line / settings.ways - 1),
      refill_cycles_(settings.refill_cycles),
      entries_(settings.size / settings.line) {}

std::uint32_t InstructionCache::next_way() {
  const bool even = std::popcount(static_cast<std::uint8_t>(shift_register_ & kTaps)) % 2 == 0;
  shift_register_ = static_cast<std::uint8_t>(shift_register_ << 1 | (even ? 1 : 0));
  return (shift_register_ >> 1) & (ways_ - 1);
}

std::uint32_t InstructionCache::fetch(std::uint32_t line, std::uint64_t tick) {
  if (const auto* entry = find(line); entry != nullptr) {
    // On its way for another core. One that is behind in time would have asked for it itself.
    const auto wait = entry->ready > tick ? entry->ready - tick : 0;
    return static_cast<std::uint32_t>(std::min<std::uint64_t>(wait, refill_cycles_));
  }
  auto& entry = entries_[(line & set_mask_) * ways_ + next_way()];
  evicted_ = entry.line;
  entry.line = line;
  entry.ready = tick + refill_cycles_;
  settled_ = std::max(settled_, entry.ready);
  ++refills_;
  return refill_cycles_;
}

void InstructionCache::flush() {
  std::fill(entries_.begin(), entries_.end(), Entry{});
}

void InstructionCache::save(state::Writer& writer) const {
  for (const auto& entry : entries_) writer.put(entry);
  writer.put(shift_register_);
  writer.put(settled_);
  writer.put(refills_);
}

void InstructionCache::restore(state::Reader& reader) {
  for (auto& entry : entries_) reader.get(entry);
  reader.get(shift_register_);
  reader.get(settled_);
  reader.get(refills_);
}

}  // namespace mebots::soc
