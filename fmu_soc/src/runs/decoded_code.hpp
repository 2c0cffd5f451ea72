// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/block_cache.hpp"
#include "hart/flow.hpp"
#include "memory/instruction_cache.hpp"
#include "memory/memory.hpp"
#include "translate/translator.hpp"

#include <cstdint>
#include <memory>

namespace mebots::soc {

/// Code as harts of one kind share it that run in the same thread and reach the same memories.
struct DecodedCode {
  /// The memory outlives it, and has all its regions.
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

  bool translates;  // hot code, as far as that turned out to be possible
  BlockCache blocks;
  const bool loose_limit;
  InstructionCache* const instruction_cache;          // null = none
  Banks* const banks;                                 // null = one user
  std::unique_ptr<translate::Translator> translator;  // made when the first block is hot
  const FlowMap* flow = nullptr;                      // who wants steps between functions to be noted
  std::uint64_t times_dropped = 0;                    // that translations were thrown away

  /// Whether some code has been translated, by any of its harts.
  bool is_translated() const { return translator != nullptr; }
  /// Instructions translated since construction. What is done again counts again.
  std::uint64_t instructions_translated() const { return is_translated() ? translator->translated() : 0; }

  void drop_translations() {
    if (translator == nullptr) return;
    times_dropped += translator->times_dropped() + 1;
    blocks.set_listener(nullptr);
    translator.reset();
  }
  void note_flow(const FlowMap* map) {
    if (map == flow) return;
    drop_translations();
    flow = map;
  }
  /// Grows whenever code that a hart has left to go on there may be gone.
  std::uint64_t version() const {
    return blocks.generation() + times_dropped + (translator == nullptr ? 0 : translator->times_dropped());
  }
};

}  // namespace mebots::soc
