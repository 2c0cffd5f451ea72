// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace mebots::soc::observe {

/// Stores the counts of a profile as integers, so that sums are exact.
struct Cost {
  std::int64_t cycles = 0;
  std::int64_t instructions = 0;
  std::int64_t time_ps = 0;
  std::int64_t energy_fj = 0;

  Cost& operator+=(const Cost& other) {
    cycles += other.cycles;
    instructions += other.instructions;
    time_ps += other.time_ps;
    energy_fj += other.energy_fj;
    return *this;
  }
  friend Cost operator-(const Cost& a, const Cost& b) {
    return {a.cycles - b.cycles, a.instructions - b.instructions, a.time_ps - b.time_ps, a.energy_fj - b.energy_fj};
  }
  friend bool operator==(const Cost&, const Cost&) = default;
};

/// Stores costs for each call stack. A node is a function, or a state of the core, together with the chain of its
/// callers.
class CallTree {
 public:
  struct Node {
    std::uint32_t parent = 0;  // number of the calling node; the root is its own parent
    std::uint32_t place = 0;
    std::uint64_t calls = 0;
    Cost self;
  };

  /// The root represents the whole run.
  CallTree() : nodes_(1) {}
  static constexpr std::uint32_t kRoot = 0;

  /// Returns the number of the child of `parent` for a place (a function, or a state of the core such as "asleep"). If
  /// there is no such child, creates it. The number of a child is greater than the number of its parent.
  std::uint32_t child(std::uint32_t parent, std::uint32_t place) {
    const auto& recent = recent_[index_of_recent(parent, place)];
    // The root is never a child.
    return recent.number != kRoot && recent.parent == parent && recent.place == place ? recent.number
                                                                                      : find(parent, place);
  }

  Node& node(std::uint32_t number) { return nodes_[number]; }
  const std::vector<Node>& nodes() const { return nodes_; }

  /// Returns the cost of each node, including the costs of its descendants.
  std::vector<Cost> inclusive() const;
  /// Returns the children of each node, in the order of their creation.
  std::vector<std::vector<std::uint32_t>> children() const;

 private:
  struct Recent {
    std::uint32_t parent = 0;
    std::uint32_t place = 0;
    std::uint32_t number = kRoot;
  };
  static constexpr std::uint32_t kRecent = 1024;

  static std::uint32_t index_of_recent(std::uint32_t parent, std::uint32_t place) {
    return (parent * 0x9e3779b1U ^ place) % kRecent;
  }
  std::uint32_t find(std::uint32_t parent, std::uint32_t place);

  std::vector<Node> nodes_;
  /// Maps a parent and a place to the node; never iterated, so that the order has no effect.
  std::unordered_map<std::uint64_t, std::uint32_t> numbers_;
  std::array<Recent, kRecent> recent_{};  // cache of the entries that were used last
};

}  // namespace mebots::soc::observe
