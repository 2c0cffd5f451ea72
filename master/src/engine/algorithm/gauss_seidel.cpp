// SPDX-License-Identifier: Apache-2.0
#include "engine/algorithm/algorithm.hpp"

#include "base/signal_guard.hpp"
#include "mebots/assert.hpp"

#include <numeric>

namespace mebots::master {
namespace {

/// The declared order, or that of the config.
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

class GaussSeidel final : public Algorithm {
 public:
  explicit GaussSeidel(const AlgorithmContext& context)
      : slaves_(&context.slaves), order_(order_of(*context.system.description)) {}

  std::optional<End> step(std::int64_t k) override {
    auto& ensemble = slaves_->ensemble();
    const auto before = ensemble.outputs();
    try {
      for (const auto i : order_) {
        if (slaves_->begins_step(i, k)) {
          slaves_->write_inputs(i, k);
          const auto result = slaves_->finish(i, k, slaves_->step(i, k));
          if (auto end = slaves_->end_of(i, k, result)) {
            ensemble.bring_back(before);  // to the last point that all reached
            return end;
          }
        }
        slaves_->read_outputs(i, k + 1);
      }
    } catch (const InterruptedError&) {
      ensemble.bring_back(before);
      throw;
    }
    return std::nullopt;
  }

 private:
  SlaveSteps* slaves_;
  std::vector<std::size_t> order_;
};

}  // namespace

std::unique_ptr<Algorithm> make_gauss_seidel(const AlgorithmContext& context) {
  return std::make_unique<GaussSeidel>(context);
}

}  // namespace mebots::master
