// SPDX-License-Identifier: Apache-2.0
// Finds loops among connections and direct dependencies of initial values by a depth-first search.
//
// The nodes are the connected variables. An output leads to the inputs connected to it; an input leads to the outputs
// that depend on it. An output without declared dependencies depends on all inputs of its instance. These edges are not
// stored, because their number can be quadratic.
#include "engine/ensemble.hpp"
#include "mebots/assert.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <tuple>
#include <unordered_map>

namespace mebots::master {
namespace {

using modeldesc::Causality;
using modeldesc::Variable;

constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

using Node = ResolvedVariable;

bool before(const Node& a, const Node& b) {
  return std::tie(a.instance, a.variable) < std::tie(b.instance, b.variable);
}

/// The dependencies of a model's outputs at initialisation. Uses InitialUnknowns; outputs that are missing there use
/// Outputs.
class Dependencies {
 public:
  explicit Dependencies(const modeldesc::ModelDescription& model) : variables_(model.variables.data()) {
    for (const auto* unknowns : {&model.initial_unknowns, &model.outputs}) {
      for (const auto& unknown : *unknowns) listed_.try_emplace(unknown.variable, &unknown.dependencies);
    }
  }

  /// Returns the variables on which `output` depends. Returns null if it may depend on every input.
  const std::vector<std::size_t>* of(const Variable& output) const {
    const auto found = listed_.find(static_cast<std::size_t>(&output - variables_));
    return found == listed_.end() || !*found->second ? nullptr : &**found->second;
  }
  const Variable* variable(std::size_t index) const { return variables_ + index; }

 private:
  const Variable* variables_;
  std::unordered_map<std::size_t, const std::optional<std::vector<std::size_t>>*> listed_;
};

/// The graph of connections and dependencies. Nodes are numbers, sorted by instance and variable.
struct Graph {
  std::vector<Node> nodes;
  std::vector<std::vector<std::size_t>> followers;  // explicit followers; in ascending order for inputs
  // Indexed by instance: outputs that depend on all inputs of the instance.
  std::vector<std::vector<std::size_t>> outputs_of_all;
  bool is_output(std::size_t node) const { return nodes[node].variable->causality == Causality::output; }

  explicit Graph(const ResolvedSystem& system) {
    for (const auto& connection : system.connections) {
      nodes.push_back(connection.from);
      nodes.push_back(connection.to);
    }
    std::ranges::sort(nodes, before);
    // std::ranges::unique() does not compile with libstdc++ and clang 14, which builds the fuzzers.
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    followers.resize(nodes.size());
    outputs_of_all.resize(system.instances.size());
    for (const auto& connection : system.connections) {
      followers[number(connection.from)].push_back(number(connection.to));
    }
    std::map<const modeldesc::ModelDescription*, Dependencies> dependencies;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (!is_output(i)) continue;
      const auto* model = system.instances[nodes[i].instance].model.get();
      add_dependencies(i, dependencies.try_emplace(model, *model).first->second);
    }
  }

 private:
  std::size_t number(const Node& node) const {
    const auto found = std::ranges::lower_bound(nodes, node, before);
    return found != nodes.end() && *found == node ? static_cast<std::size_t>(found - nodes.begin()) : kNone;
  }

  void add_dependencies(std::size_t output, const Dependencies& dependencies) {
    const auto instance = nodes[output].instance;
    const auto* listed = dependencies.of(*nodes[output].variable);
    if (listed == nullptr) {
      outputs_of_all[instance].push_back(output);
      return;
    }
    for (const auto index : std::set<std::size_t>(listed->begin(), listed->end())) {
      const auto input = number({instance, dependencies.variable(index)});
      if (input != kNone && !is_output(input)) followers[input].push_back(output);
    }
  }
};

/// The outputs of an instance that depend on all of its inputs. Stores which outputs a search has visited.
class SharedFollowers {
 public:
  explicit SharedFollowers(const std::vector<std::size_t>& outputs) : outputs_(&outputs), next_(outputs.size() + 1) {
    std::iota(next_.begin(), next_.end(), std::size_t{0});
  }

  /// Returns the first unvisited output with a node number of at least `from`, or kNone.
  std::size_t unseen(std::size_t from) {
    const auto place = skip(place_of(from));
    return place == outputs_->size() ? kNone : (*outputs_)[place];
  }
  /// Returns the first output on the current path of the search with a node number of at least `from`, or kNone.
  std::size_t open(std::size_t from) const {
    const auto found = open_.lower_bound(from);
    return found == open_.end() ? kNone : *found;
  }
  void enter(std::size_t output) {
    const auto place = place_of(output);
    // Ignores an output that is not in `outputs_`, because it declares the inputs on which it depends.
    if (place == outputs_->size() || (*outputs_)[place] != output) return;
    next_[place] = place + 1;
    open_.insert(output);
  }
  void leave(std::size_t output) { open_.erase(output); }

 private:
  std::size_t place_of(std::size_t node) const {
    return static_cast<std::size_t>(std::ranges::lower_bound(*outputs_, node) - outputs_->begin());
  }
  /// Returns the first unvisited index at or after `place`. Shortens the chain of links (path compression).
  std::size_t skip(std::size_t place) {
    auto end = place;
    while (next_[end] != end) end = next_[end];
    while (next_[place] != place) place = std::exchange(next_[place], end);
    return end;
  }

  const std::vector<std::size_t>* outputs_;
  // Links each element of `outputs_` to itself if it is unvisited, otherwise to a later element. The additional last
  // entry marks the end.
  std::vector<std::size_t> next_;
  std::set<std::size_t> open_;
};

/// A depth-first search with its own stack, because long chains would overflow the call stack.
class Search {
 public:
  explicit Search(const Graph& graph) : graph_(graph), colours_(graph.nodes.size(), Colour::unseen) {
    for (const auto& outputs : graph.outputs_of_all) shared_.emplace_back(outputs);
  }

  /// Calls back(from, to) for each edge that closes a loop. Within the call, path_from(to) returns the loop. Stops if
  /// `back` returns false. Does not find all loops: after an input has closed one loop, skips its further loops through
  /// outputs that depend on all inputs of the instance.
  template <typename Back>
  void run(Back back) {
    for (std::size_t start = 0; start < graph_.nodes.size(); ++start) {
      if (colours_[start] != Colour::unseen) continue;
      enter(start);
      while (!path_.empty()) {
        const auto follower = next();
        if (follower == kNone) {
          leave();
        } else if (colours_[follower] == Colour::unseen) {
          enter(follower);
        } else if (colours_[follower] == Colour::open) {
          path_.back().closed = true;
          if (!back(path_.back().node, follower)) return;
        }
      }
    }
  }

  /// Returns the nodes of the path from the node `first` to the end of the path.
  std::vector<std::size_t> path_from(std::size_t first) const {
    const auto begin = std::ranges::find(path_, first, &Visit::node);
    std::vector<std::size_t> nodes;
    std::transform(begin, path_.end(), std::back_inserter(nodes), [](const Visit& visit) { return visit.node; });
    return nodes;
  }

 private:
  enum class Colour : std::uint8_t { unseen, open, done };
  struct Visit {
    std::size_t node;
    std::size_t next_listed = 0;  // index of the next explicit follower
    std::size_t shared_from = 0;  // smallest node number of the next implicit follower
    bool closed = false;          // true if an edge of this node has closed a loop
  };

  SharedFollowers& shared_of(std::size_t node) { return shared_[graph_.nodes[node].instance]; }

  void enter(std::size_t node) {
    MEBOTS_ASSERT(colours_[node] == Colour::unseen);
    colours_[node] = Colour::open;
    if (graph_.is_output(node)) shared_of(node).enter(node);
    path_.push_back({.node = node});
  }
  void leave() {
    const auto node = path_.back().node;
    colours_[node] = Colour::done;
    if (graph_.is_output(node)) shared_of(node).leave(node);
    path_.pop_back();
  }

  /// Returns the next node to which an edge leads from the last node of the path, or kNone if there are no more edges.
  /// If the last node is an input, returns its followers in ascending order.
  std::size_t next() {
    auto& visit = path_.back();
    const auto& listed = graph_.followers[visit.node];
    const auto next_listed = visit.next_listed < listed.size() ? listed[visit.next_listed] : kNone;
    std::size_t next_shared = kNone;
    if (!graph_.is_output(visit.node)) {
      auto& shared = shared_of(visit.node);
      next_shared = shared.unseen(visit.shared_from);
      if (!visit.closed) next_shared = std::min(next_shared, shared.open(visit.shared_from));
    }
    if (next_shared < next_listed) {
      visit.shared_from = next_shared + 1;
      return next_shared;
    }
    ++visit.next_listed;
    return next_listed;
  }

  const Graph& graph_;
  std::vector<Colour> colours_;
  std::vector<SharedFollowers> shared_;
  std::vector<Visit> path_;
};

}  // namespace

std::vector<ResolvedVariable> torn_inputs(const ResolvedSystem& system) {
  const Graph graph(system);
  std::vector<bool> is_torn(graph.nodes.size(), false);
  std::vector<ResolvedVariable> inputs;
  Search(graph).run([&](std::size_t from, std::size_t to) {
    const auto input = graph.is_output(to) ? from : to;
    if (!is_torn[input]) inputs.push_back(graph.nodes[input]);
    is_torn[input] = true;
    return true;
  });
  return inputs;
}

std::string initial_loop(const ResolvedSystem& system) {
  const Graph graph(system);
  Search search(graph);
  std::vector<std::size_t> loop;
  search.run([&](std::size_t /*from*/, std::size_t to) {
    loop = search.path_from(to);
    return false;
  });
  if (loop.empty()) return {};
  std::string text;
  for (const auto node : loop) text += system.text(graph.nodes[node]) + " -> ";
  return text + system.text(graph.nodes[loop.front()]);
}

}  // namespace mebots::master
