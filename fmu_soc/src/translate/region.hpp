// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/block_cache.hpp"

#include <cstdint>
#include <vector>

namespace mebots::soc::translate {

/// A block as part of a region.
struct Node {
  std::uint32_t number = 0;  // of the block
  const Block* block = nullptr;
  const Instruction* first = nullptr;
  std::uint32_t weight = 1;  // how often it runs, guessed: 8 to the power of the loops it lies in
};

/// Blocks that are translated together, so that registers stay in host registers from one to the next.
struct Region {
  std::vector<Node> nodes;  // the first is where the region is entered

  const Node* find(std::uint32_t number) const {
    for (const auto& node : nodes) {
      if (node.number == number) return &node;
    }
    return nullptr;
  }
};

/// The block `head` and what follows it by links that have been taken.
Region grow_region(const BlockCache& cache, std::uint32_t head);

}  // namespace mebots::soc::translate
