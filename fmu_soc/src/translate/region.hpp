// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/block_cache.hpp"
#include "mebots/assert.hpp"

#include <cstdint>
#include <functional>
#include <vector>

namespace mebots::soc::translate {

struct Node {
  std::uint32_t number = 0;  // number of the block
  const Block* block = nullptr;
  const Instruction* first = nullptr;
  std::uint32_t weight = 1;   // estimated frequency of execution: 8 to the power of the loop depth
  bool is_loop_head = false;  // if true, a loop of the region begins with this block

  /// Returns the end of the block. The `index` of the end is the number of instructions.
  const Instruction* end() const {
    const auto* at = first;
    while (!is_block_end(at->op)) ++at;
    return at;
  }
};

/// Blocks that are translated together. Guest registers stay in host registers between these blocks.
struct Region {
  std::vector<Node> nodes;  // in the order of their code; the first node is the block whose translation was requested

  const Node* find(std::uint32_t number) const {
    for (const auto& node : nodes) {
      if (node.number == number) return &node;
    }
    return nullptr;
  }
};

/// Returns a region that starts with the block `head`. It also contains blocks that were executed after `head`,
/// directly or through other blocks, up to a maximum size. Excludes blocks that already have code.
Region grow_region(const BlockCache& blocks, std::uint32_t head, const std::function<bool(std::uint32_t)>& has_code);

/// Returns the number of the block to which the link of an instruction leads, or 0 if the link is not set or the block
/// does not start at `pc`.
inline std::uint32_t linked(const BlockCache& blocks, std::uint32_t link, std::uint32_t pc) {
  return link != 0 && blocks.block(link).pc == pc ? link : 0;
}

/// Returns true if the block's first instruction stalls because the previous block ends with a load. `end` is the end
/// of the previous block.
inline bool stalls(const Block& block, const Instruction* end) {
  MEBOTS_ASSERT(is_block_end(end->op));
  return end->index != 0 && block.stall_after(executed(end[-1], false)) != 0;
}

/// Returns true if the last instructions of the previous block may change the cycles of a jump at the start of the
/// block. `end` is the end of the previous block. Ignores misaligned loads at the end of a block, because the
/// interpreter executes them.
inline bool delays_jump(const BlockCache& blocks, const Block& block, const Instruction* end) {
  MEBOTS_ASSERT(is_block_end(end->op));
  if (!block.early_jump) return false;
  if (end->index < 2) return true;
  return blocks.delays_jump(block, one_later(executed(end[-2], false)), executed(end[-1], false));
}

}  // namespace mebots::soc::translate
