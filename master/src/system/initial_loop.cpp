// SPDX-License-Identifier: Apache-2.0
#include "system/ensemble.hpp"

#include <algorithm>
#include <map>
#include <tuple>

namespace mebots::master {
namespace {

using modeldesc::Causality;
using modeldesc::Variable;

struct Node {
  std::size_t instance;
  const Variable* variable;
  bool operator==(const Node&) const = default;
  bool operator<(const Node& other) const {
    return std::tie(instance, variable) < std::tie(other.instance, other.variable);
  }
};

using Graph = std::map<Node, std::vector<Node>>;

/// Inputs that an output's initial value may depend on: as InitialUnknowns says, else as Outputs says,
/// else all.
std::vector<const Variable*> inputs_of(const modeldesc::ModelDescription& model, const Variable& output) {
  const auto index = static_cast<std::size_t>(&output - model.variables.data());
  const std::vector<std::size_t>* listed = nullptr;
  for (const auto* unknowns : {&model.initial_unknowns, &model.outputs}) {
    const auto found = std::find_if(unknowns->begin(), unknowns->end(),
                                    [&](const modeldesc::Unknown& unknown) { return unknown.variable == index; });
    if (found == unknowns->end()) continue;
    if (found->dependencies) listed = &*found->dependencies;
    break;
  }
  std::vector<const Variable*> inputs;
  for (std::size_t i = 0; i < model.variables.size(); ++i) {
    if (model.variables[i].causality != Causality::input) continue;
    if (listed == nullptr || std::find(listed->begin(), listed->end(), i) != listed->end()) {
      inputs.push_back(&model.variables[i]);
    }
  }
  return inputs;
}

Graph dependency_graph(const ResolvedSystem& system) {
  Graph graph;
  for (const auto& connection : system.connections) {
    const Node from{connection.from.instance, connection.from.variable};
    const Node to{connection.to.instance, connection.to.variable};
    graph[from].push_back(to);
    graph.try_emplace(to);
  }
  for (auto& [node, followers] : graph) {
    if (node.variable->causality != Causality::output) continue;
    for (const auto* input : inputs_of(system.instances[node.instance].fmu->description(), *node.variable)) {
      const auto found = graph.find(Node{node.instance, input});
      if (found != graph.end()) found->second.push_back(node);
    }
  }
  return graph;
}

/// Depth-first search with an explicit stack: ensembles may be long chains. Calls back(path) for every edge that
/// closes a loop; the path goes from where the edge ends to where it begins. Stops when `back` returns false.
template <typename Back>
void search(const Graph& graph, Back back) {
  enum class Colour { unseen, open, done };
  std::map<Node, Colour> colours;
  struct Visit {
    Node node;
    std::size_t next;
  };
  for (const auto& [start, unused] : graph) {
    if (colours[start] != Colour::unseen) continue;
    std::vector<Visit> path{{start, 0}};
    colours[start] = Colour::open;
    while (!path.empty()) {
      auto& visit = path.back();
      const auto& followers = graph.at(visit.node);
      if (visit.next == followers.size()) {
        colours[visit.node] = Colour::done;
        path.pop_back();
        continue;
      }
      const auto follower = followers[visit.next++];
      if (colours[follower] == Colour::open) {
        std::vector<Node> loop;
        for (auto at = path.rbegin(); at != path.rend(); ++at) {
          loop.push_back(at->node);
          if (at->node == follower) break;
        }
        std::reverse(loop.begin(), loop.end());
        if (!back(loop)) return;
      }
      if (colours[follower] == Colour::unseen) {
        colours[follower] = Colour::open;
        path.push_back({follower, 0});
      }
    }
  }
}

std::vector<Node> find_loop(const Graph& graph) {
  std::vector<Node> found;
  search(graph, [&](const std::vector<Node>& loop) {
    found = loop;
    return false;
  });
  return found;
}

}  // namespace

std::vector<ResolvedVariable> torn_inputs(const ResolvedSystem& system) {
  std::vector<ResolvedVariable> inputs;
  search(dependency_graph(system), [&](const std::vector<Node>& loop) {
    // The closing edge is a connection into the path's first node, or hangs on its last, an input.
    const auto& input = loop.front().variable->causality == Causality::input ? loop.front() : loop.back();
    const ResolvedVariable torn{input.instance, input.variable};
    if (std::find(inputs.begin(), inputs.end(), torn) == inputs.end()) inputs.push_back(torn);
    return true;
  });
  return inputs;
}

std::string initial_loop(const ResolvedSystem& system) {
  const auto loop = find_loop(dependency_graph(system));
  if (loop.empty()) return {};
  std::string text;
  for (const auto& node : loop) text += system.text({node.instance, node.variable}) + " -> ";
  return text + system.text({loop.front().instance, loop.front().variable});
}

}  // namespace mebots::master
