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
  std::uint32_t weight = 1;  // estimate of how often it runs: 8 to the power of its loop depth

  /// Returns the slot after the node's last instruction. The index of this slot is the number of the node's
  /// instructions.
  const Instruction* end() const {
    const auto* at = first;
    while (!is_block_end(at->op)) ++at;
    return at;
  }
};

/// Blocks that are translated together. From one block to the next, guest registers stay in host registers.
struct Region {
  std::vector<Node> nodes;  // in the order of their code; the first is the one whose translation was requested

  const Node* find(std::uint32_t number) const {
    for (const auto& node : nodes) {
      if (node.number == number) return &node;
    }
    return nullptr;
  }
};

/// Returns the block `head` and blocks that were executed after it, directly or through others, up to a maximum size.
/// Blocks that already have code are excluded.
Region grow_region(const BlockCache& blocks, std::uint32_t head, const std::function<bool(std::uint32_t)>& has_code);

/// Returns the block to which an instruction's link leads. If this block does not start at `pc`, or if the link is not
/// set, returns 0.
inline std::uint32_t linked(const BlockCache& blocks, std::uint32_t link, std::uint32_t pc) {
  return link != 0 && blocks.block(link).pc == pc ? link : 0;
}

/// True if the block's first instruction stalls because of a load at the end of the previous block. `end` is the slot
/// after that load.
inline bool stalls(const Block& block, const Instruction* end) {
  MEBOTS_ASSERT(is_block_end(end->op));
  return end->index != 0 && block.stall_after(executed(end[-1], false)) != 0;
}

/// True if the cycles of a jump at the start of the block depend, or may depend, on the last instructions of the
/// previous block. `end` is the slot after these instructions. If a block ends with a misaligned load, the interpreter
/// executes the load.
inline bool delays_jump(const BlockCache& blocks, const Block& block, const Instruction* end) {
  MEBOTS_ASSERT(is_block_end(end->op));
  if (!block.early_jump) return false;
  if (end->index < 2) return true;
  return blocks.delays_jump(block, one_later(executed(end[-2], false)), executed(end[-1], false));
}

}  // namespace mebots::soc::translate
