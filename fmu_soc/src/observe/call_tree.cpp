// SPDX-License-Identifier: Apache-2.0
#include "observe/call_tree.hpp"

namespace mebots::soc::observe {

std::uint32_t CallTree::find(std::uint32_t parent, std::uint32_t place) {
  const auto [found, is_new] =
      numbers_.try_emplace(std::uint64_t{parent} << 32 | place, static_cast<std::uint32_t>(nodes_.size()));
  if (is_new) nodes_.push_back({parent, place, 0, {}});
  recent_[index_of_recent(parent, place)] = {parent, place, found->second};
  return found->second;
}

std::vector<Cost> CallTree::inclusive() const {
  std::vector<Cost> sums(nodes_.size());
  for (auto i = nodes_.size(); i-- > 0;) {
    sums[i] += nodes_[i].self;
    if (i != kRoot) sums[nodes_[i].parent] += sums[i];
  }
  return sums;
}

std::vector<std::vector<std::uint32_t>> CallTree::children() const {
  std::vector<std::vector<std::uint32_t>> lists(nodes_.size());
  for (std::uint32_t i = 1; i < nodes_.size(); ++i) lists[nodes_[i].parent].push_back(i);
  return lists;
}

}  // namespace mebots::soc::observe
