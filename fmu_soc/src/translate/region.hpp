// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/block_cache.hpp"
#include "mebots/assert.hpp"

#include <cstdint>
#include <functional>
#include <vector>

namespace mebots::soc::translate {

/// A block as part of a region.
struct Node {
  std::uint32_t number = 0;  // of the block
  const Block* block = nullptr;
  const Instruction* first = nullptr;
  std::uint32_t weight = 1;  // how often it runs, guessed: 8 to the power of the loops it lies in

  /// What stands behind its last instruction; its index says how many there are.
  const Instruction* end() const {
    const auto* at = first;
    while (!is_block_end(at->op)) ++at;
    return at;
  }
};

/// Blocks that are translated together, so that registers stay in host registers from one to the next.
struct Region {
  std::vector<Node> nodes;  // the first is where the region is entered; in the order of their code

  const Node* find(std::uint32_t number) const {
    for (const auto& node : nodes) {
      if (node.number == number) return &node;
    }
    return nullptr;
  }
};

/// The block `head` and what follows it by links that have been taken, without what has code already.
Region grow_region(const BlockCache& blocks, std::uint32_t head, const std::function<bool(std::uint32_t)>& has_code);

/// The block to which an instruction's link has led, at `pc`; 0 when it is not known, or invalid now.
inline std::uint32_t linked(const BlockCache& blocks, std::uint32_t link, std::uint32_t pc) {
  return link != 0 && blocks.block(link).pc == pc ? link : 0;
}

/// Whether the block's first instruction waits for a load that ends the block before, which `end` stands behind.
inline bool stalls(const Block& block, const Instruction* end) {
  MEBOTS_ASSERT(is_block_end(end->op));
  return end->index != 0 && is_load(end[-1].op) && (block.stalled_by >> end[-1].rd & 1U) != 0;
}

/// Whether an early jump of the block waits for what ends the block before, which `end` stands behind; also where only
/// a run can tell. (A load across two words that ends a block is left to the interpreter.)
inline bool delays_jump(const BlockCache& blocks, const Block& block, const Instruction* end) {
  MEBOTS_ASSERT(is_block_end(end->op));
  if (!block.early_jump) return false;
  if (end->index < 2) return true;
  return blocks.delays_jump(block, one_later(executed(end[-2], false)), executed(end[-1], false));
}

}  // namespace mebots::soc::translate
