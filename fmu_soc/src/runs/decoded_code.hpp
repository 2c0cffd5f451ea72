// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/block_cache.hpp"
#include "hart/instruction.hpp"
#include "memory/instruction_cache.hpp"
#include "memory/memory.hpp"
#include "translate/translator.hpp"

#include <cstdint>
#include <memory>

namespace mebots::soc {

/// Decoded code that several harts share. These harts have the same settings and memories, and run in one thread.
struct DecodedCode {
  /// The memory must outlive this object, and must already have all its regions.
  DecodedCode(Memory& memory, const CodeSettings& settings)
      : translates(settings.translate && translate::can_translate()),
        blocks(memory, settings, translates),
        loose_limit(settings.loose_limit),
        instruction_cache(settings.instruction_cache),
        banks(settings.banks) {
    if (instruction_cache != nullptr) instruction_cache->cover(memory);
  }
  DecodedCode(const DecodedCode&) = delete;
  DecodedCode& operator=(const DecodedCode&) = delete;

  bool translates;  // hot code is translated
  BlockCache blocks;
  const bool loose_limit;
  InstructionCache* const instruction_cache;          // null = none
  Banks* const banks;                                 // null = only one core uses the memory
  std::unique_ptr<translate::Translator> translator;  // created when the first block is hot
  const FlowMap* flow = nullptr;                      // null = steps between functions are not recorded
  std::uint64_t times_dropped = 0;                    // number of discarded translations

  /// Returns true if translated code calls the interpreter for an instruction without host code, and then continues.
  /// This is not the case if blocks may run past the limit (loose limit), or if steps into other functions are
  /// recorded.
  bool performs_rare() const { return !loose_limit && flow == nullptr; }
  bool is_translated() const { return translator != nullptr; }
  /// Returns the number of instructions translated since the last drop_translations(). A repeated translation of an
  /// instruction is counted again.
  std::uint64_t instructions_translated() const { return is_translated() ? translator->translated() : 0; }

  void drop_translations() {
    if (translator == nullptr) return;
    times_dropped += translator->times_dropped() + 1;
    blocks.set_listener(nullptr);
    translator.reset();
  }
  void record_flow(const FlowMap* map) {
    if (map == flow) return;
    drop_translations();
    flow = map;
  }
  /// Increases whenever code at which a hart would resume may have been dropped.
  std::uint64_t version() const {
    return blocks.generation() + times_dropped + (translator == nullptr ? 0 : translator->times_dropped());
  }
};

}  // namespace mebots::soc
