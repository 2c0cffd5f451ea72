// SPDX-License-Identifier: Apache-2.0
#include "translate/region.hpp"

#include "mebots/assert.hpp"

#include <algorithm>
#include <utility>

namespace mebots::soc::translate {
namespace {

constexpr std::size_t kMostNodes = 24;
constexpr std::size_t kMostInstructions = 600;
constexpr std::uint32_t kLoopWeight = 8;
constexpr std::uint32_t kMostWeight = kLoopWeight * kLoopWeight * kLoopWeight * kLoopWeight;

/// Calls `visit` with the number of every block that was executed directly after the node.
template <typename Visit>
void for_successors(const Node& node, Visit visit) {
  const auto* at = node.first;
  for (; !is_block_end(at->op); ++at) {
    if ((is_branch(at->op) || is_jump(at->op) || is_trap(at->op)) && at->link != 0) visit(at->link);
  }
  if (at->op == Op::loop_end && at[1].link != 0) visit(at[1].link);  // first block of the next iteration
  if (at->link != 0) visit(at->link);
}

/// Sets the weight of each node from its loop depth. An edge belongs to a loop if its start can be reached from its
/// end.
class LoopFinder {
 public:
  explicit LoopFinder(Region& region) : region_(region), states_(region.nodes.size(), State::unseen) {
    from_.resize(region.nodes.size());
    for (std::size_t i = 0; i < region.nodes.size(); ++i) {
      for_successors(region.nodes[i], [&](std::uint32_t number) {
        if (const auto* node = region.find(number); node != nullptr) from_[index_of(*node)].push_back(i);
      });
    }
  }

  void weigh_loops() { descend(0); }

 private:
  enum class State : std::uint8_t { unseen, open, done };

  std::size_t index_of(const Node& node) const { return static_cast<std::size_t>(&node - region_.nodes.data()); }

  void descend(std::size_t i) {
    states_[i] = State::open;
    for_successors(region_.nodes[i], [&](std::uint32_t number) {
      const auto* node = region_.find(number);
      if (node == nullptr) return;
      const auto next = index_of(*node);
      if (states_[next] == State::open) weigh(next, i);
      if (states_[next] == State::unseen) descend(next);
    });
    states_[i] = State::done;
  }

  /// Multiplies the weights of a loop's nodes: `head`, and all nodes that reach `last` without passing `head`.
  void weigh(std::size_t head, std::size_t last) {
    region_.nodes[head].is_loop_head = true;
    std::vector<bool> inside(region_.nodes.size());
    std::vector<std::size_t> waiting{last};
    inside[head] = true;
    while (!waiting.empty()) {
      const auto i = waiting.back();
      waiting.pop_back();
      if (inside[i]) continue;
      inside[i] = true;
      waiting.insert(waiting.end(), from_[i].begin(), from_[i].end());
    }
    for (std::size_t i = 0; i < inside.size(); ++i) {
      auto& weight = region_.nodes[i].weight;
      if (inside[i]) weight = std::min(weight * kLoopWeight, kMostWeight);
    }
  }

  Region& region_;
  std::vector<State> states_;
  std::vector<std::vector<std::size_t>> from_;
};

/// Returns the block that was executed most recently after the end of a node, or 0 if no block was executed there.
std::uint32_t next_of(const Node& node) {
  const auto* at = node.end();
  return at->link != 0 || at->index == 0 || !is_jump(at[-1].op) ? at->link : at[-1].link;
}

/// Places the successor of each node directly after the node, unless the successor was already placed. The first of two
/// such nodes needs no jump to the second.
void put_in_order(Region& region) {
  std::vector<Node> ordered;
  ordered.reserve(region.nodes.size());
  const auto is_placed = [&ordered](const Node& node) {
    return std::any_of(ordered.begin(), ordered.end(), [&](const Node& other) { return other.number == node.number; });
  };
  for (const auto& first : region.nodes) {
    for (const auto* node = &first; node != nullptr && !is_placed(*node); node = region.find(next_of(*node))) {
      ordered.push_back(*node);
    }
  }
  region.nodes = std::move(ordered);
}

}  // namespace

Region grow_region(const BlockCache& blocks, std::uint32_t head, const std::function<bool(std::uint32_t)>& has_code) {
  Region region;
  std::size_t instructions = 0;
  const auto add = [&](std::uint32_t number) {
    if (region.nodes.size() == kMostNodes || instructions >= kMostInstructions) return;
    if (!blocks.block(number).valid() || region.find(number) != nullptr || has_code(number)) return;
    const auto& block = blocks.block(number);
    region.nodes.push_back({number, &block, blocks.instructions(block)});
    instructions += region.nodes.back().end()->index;
  };
  add(head);
  MEBOTS_ASSERT(region.nodes.size() == 1, "its head is valid and has no code");
  for (std::size_t i = 0; i < region.nodes.size(); ++i) for_successors(Node(region.nodes[i]), add);
  LoopFinder(region).weigh_loops();
  put_in_order(region);
  return region;
}

}  // namespace mebots::soc::translate
