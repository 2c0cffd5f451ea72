// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/block_cache.hpp"
#include "hart/flow.hpp"
#include "hart/timing.hpp"
#include "memory/memory.hpp"
#include "translate/translator.hpp"

#include <array>
#include <cstdint>
#include <memory>

namespace mebots::soc {

class Banks;

/// Energy of one instruction by kind [fJ], at the reference voltage.
struct InstructionEnergy {
  std::array<std::uint32_t, kOpCount> fj{};
};

/// Code as harts of one kind share it that run in the same thread and reach the same memories.
struct DecodedCode {
  /// `banks`: of the first memory, when its users may have to wait for each other; null = one user.
  DecodedCode(Memory& memory, Timing timing, const InstructionEnergy& energy, Banks* shared_banks = nullptr)
      : blocks(memory, timing, energy), banks(shared_banks) {}

  BlockCache blocks;
  Banks* banks;
  std::unique_ptr<translate::Translator> translator;  // made when the first block is hot
  const FlowMap* flow = nullptr;                      // who wants steps between functions to be noted
  std::uint64_t times_dropped = 0;                    // that translations were thrown away

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
