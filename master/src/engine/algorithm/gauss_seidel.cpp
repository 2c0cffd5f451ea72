// SPDX-License-Identifier: Apache-2.0
#include "engine/algorithm/algorithm.hpp"

#include "base/signal_guard.hpp"
#include "mebots/assert.hpp"

#include <numeric>
#include <set>

namespace mebots::master {
namespace {

/// Returns the order of the instances under `algorithm` in the config. If the config states no order, returns the order
/// of declaration.
std::vector<std::size_t> order_of(const SystemDescription& system) {
  std::vector<std::size_t> order(system.instances.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto& names = system.algorithm.order;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto found = system.index_of(names[i]);
    MEBOTS_ASSERT(found && i < order.size(), "the reader has looked the names up");
    order[i] = *found;
  }
  return order;
}

/// Instances that step together: a single instance, or all members of a continuous system or clock group. They step at
/// the position of their first member in the order.
using Turn = std::vector<std::size_t>;

std::vector<Turn> turns_of(const ResolvedSystem& system) {
  std::vector<const Turn*> groups(system.instances.size(), nullptr);
  const auto add = [&](const Turn& members) {
    for (const auto member : members) groups[member] = &members;
  };
  for (const auto& continuous : system.continuous_systems) add(continuous.members);
  for (const auto& clocks : system.clock_groups) add(clocks.members);
  std::vector<Turn> turns;
  std::set<const Turn*> taken;
  for (const auto i : order_of(*system.description)) {
    if (groups[i] == nullptr) {
      turns.push_back({i});
    } else if (taken.insert(groups[i]).second) {
      turns.push_back(*groups[i]);
    }
  }
  return turns;
}

class GaussSeidel final : public Algorithm {
 public:
  explicit GaussSeidel(const AlgorithmContext& context) : slaves_(&context.slaves), turns_(turns_of(context.system)) {}

  std::optional<End> step(const GridStep& span) override {
    auto& ensemble = slaves_->ensemble();
    const auto before = ensemble.outputs();
    try {
      for (const auto& turn : turns_) {
        for (const auto i : turn) slaves_->write_inputs(i, span.from);
        for (const auto i : turn) {
          if (!slaves_->begins_step(i, span.from)) continue;
          const auto result = slaves_->finish(i, span, slaves_->step(i, span));
          if (auto end = slaves_->end_of(i, span.from, result)) {
            ensemble.bring_back(before);  // restores the outputs at the start of the step
            return end;
          }
        }
        for (const auto i : turn) slaves_->read_outputs(i, span.to);
      }
    } catch (const InterruptedError&) {
      ensemble.bring_back(before);
      throw;
    }
    return std::nullopt;
  }

 private:
  SlaveSteps* slaves_;
  std::vector<Turn> turns_;
};

}  // namespace

std::unique_ptr<Algorithm> make_gauss_seidel(const AlgorithmContext& context) {
  return std::make_unique<GaussSeidel>(context);
}

}  // namespace mebots::master
