// SPDX-License-Identifier: Apache-2.0
// Tests the search for loops of initial values on random systems: compares it with a recursive search over all edges.
#include "engine/ensemble.hpp"
#include "mebots/modeldesc/archive.hpp"
#include "mebots/modeldesc/xml.hpp"

#include "test_system.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <random>
#include <set>

namespace mebots::test {
namespace {

using master::ResolvedConnection;
using master::ResolvedSystem;
using master::ResolvedVariable;
using Edges = std::map<std::pair<std::size_t, std::size_t>, std::vector<std::pair<std::size_t, std::size_t>>>;

constexpr std::size_t kInputs = 3;
constexpr std::size_t kOutputs = 3;
using Random = std::mt19937;

std::size_t below(Random& random, std::size_t limit) {
  return std::uniform_int_distribution<std::size_t>(0, limit - 1)(random);
}

/// An FMU with random dependencies. Outputs that declare none depend on every input.
struct RandomFmu {
  explicit RandomFmu(Random& random) {
    std::string variables;
    std::string unknowns;
    for (std::size_t i = 0; i < kInputs; ++i) {
      variables += fmt::format(
          R"(<ScalarVariable name="u{0}" valueReference="{0}" causality="input"><Real start="0"/></ScalarVariable>)",
          i);
    }
    for (std::size_t i = 0; i < kOutputs; ++i) {
      const auto index = kInputs + i;
      variables += fmt::format(
          R"(<ScalarVariable name="y{}" valueReference="{}" causality="output"><Real/></ScalarVariable>)", i, index);
      if (below(random, 3) == 0) {
        unknowns += fmt::format(R"(<Unknown index="{}"/>)", index + 1);
        dependencies.push_back({0, 1, 2});
        continue;
      }
      std::set<std::size_t> chosen;
      for (std::size_t k = 0; k < kInputs; ++k) {
        if (below(random, 3) == 0) chosen.insert(k);
      }
      std::string text;
      for (const auto k : chosen) text += fmt::format("{} ", k + 1);
      unknowns += fmt::format(R"(<Unknown index="{}" dependencies="{}"/>)", index + 1, text);
      dependencies.emplace_back(chosen.begin(), chosen.end());
    }
    write_file(
        folder.path() / "modelDescription.xml",
        fmt::format(R"(<fmiModelDescription fmiVersion="2.0" modelName="m" guid="g"><CoSimulation )"
                    R"(modelIdentifier="m"/><ModelVariables>{}</ModelVariables><ModelStructure><Outputs>{}</Outputs>)"
                    R"(</ModelStructure></fmiModelDescription>)",
                    variables, unknowns));
    model = std::make_shared<modeldesc::ModelDescription>(modeldesc::read_xml(folder.path() / "modelDescription.xml"));
  }

  modeldesc::TemporaryFolder folder{"mebots-test"};
  std::vector<std::vector<std::size_t>> dependencies;  // inputs of each output
  std::shared_ptr<const modeldesc::ModelDescription> model;
};

struct RandomSystem {
  explicit RandomSystem(unsigned seed) {
    Random random(seed);
    const auto count = 1 + below(random, 5);
    for (std::size_t i = 0; i < count; ++i) {
      fmus.push_back(std::make_unique<RandomFmu>(random));
      system.instances.emplace_back().model = fmus.back()->model;
    }
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t k = 0; k < kInputs; ++k) {
        if (below(random, 2) == 0) continue;
        auto& connection = system.connections.emplace_back();
        connection.from = variable(below(random, count), kInputs + below(random, kOutputs));
        connection.to = variable(i, k);
      }
    }
  }

  ResolvedVariable variable(std::size_t instance, std::size_t index) const {
    return {instance, &system.instances[instance].model->variables[index]};
  }
  std::size_t index(const ResolvedVariable& variable) const {
    return static_cast<std::size_t>(variable.variable - system.instances[variable.instance].model->variables.data());
  }

  /// Returns the edges between connected variables, and those from inputs to outputs of an FMU. Omits connections to
  /// the inputs in `without`.
  Edges edges(const std::set<std::pair<std::size_t, std::size_t>>& without = {}) const {
    Edges edges;
    for (const auto& connection : system.connections) {
      const std::pair from(connection.from.instance, index(connection.from));
      const std::pair to(connection.to.instance, index(connection.to));
      edges[from];
      edges[to];
      if (!without.contains(to)) edges[from].push_back(to);
    }
    for (auto& [node, followers] : edges) {
      if (node.second < kInputs) continue;
      for (const auto input : fmus[node.first]->dependencies[node.second - kInputs]) {
        const auto found = edges.find({node.first, input});
        if (found != edges.end()) found->second.push_back(node);
      }
    }
    return edges;
  }

  std::vector<std::unique_ptr<RandomFmu>> fmus;
  ResolvedSystem system;
};

/// Returns the inputs that close a loop, in the order of a recursive depth-first search.
std::vector<std::pair<std::size_t, std::size_t>> torn_by_recursion(const Edges& edges) {
  std::map<std::pair<std::size_t, std::size_t>, int> colours;
  std::vector<std::pair<std::size_t, std::size_t>> torn;
  const std::function<void(std::pair<std::size_t, std::size_t>)> visit = [&](auto node) {
    colours[node] = 1;
    for (const auto& follower : edges.at(node)) {
      if (colours[follower] == 0) visit(follower);
      if (colours[follower] != 1) continue;
      const auto input = follower.second < kInputs ? follower : node;
      if (std::ranges::find(torn, input) == torn.end()) torn.push_back(input);
    }
    colours[node] = 2;
  };
  for (const auto& [node, followers] : edges) {
    if (colours[node] == 0) visit(node);
  }
  return torn;
}

TEST(InitialLoop, TornInputsAreThoseOfASearchOverAllEdgesAndLeaveNoLoop) {
  constexpr unsigned kSystems = 300;
  std::size_t with_loops = 0;
  for (unsigned seed = 0; seed < kSystems; ++seed) {
    const RandomSystem random(seed);
    std::vector<std::pair<std::size_t, std::size_t>> torn;
    for (const auto& input : torn_inputs(random.system)) torn.emplace_back(input.instance, random.index(input));
    EXPECT_EQ(torn, torn_by_recursion(random.edges())) << "seed " << seed;
    EXPECT_TRUE(torn_by_recursion(random.edges({torn.begin(), torn.end()})).empty()) << "seed " << seed;
    with_loops += torn.empty() ? 0 : 1;
  }
  EXPECT_GT(with_loops, kSystems / 4);
  EXPECT_LT(with_loops, kSystems);
}

}  // namespace
}  // namespace mebots::test
