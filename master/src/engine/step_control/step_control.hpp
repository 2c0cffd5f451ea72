// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/algorithm/algorithm.hpp"
#include "engine/step_control/coupling_measure.hpp"
#include "engine/step_control/forced_points.hpp"
#include "engine/step_control/step_size_controller.hpp"
#include "model/step_statistics.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace mebots::master {

/// Adapts the length of the communication steps to the coupling error.
class StepControl {
 public:
  /// All arguments must outlive this object; `overrides` may be null. Must be created before Ensemble::initialize().
  /// Throws InputError if a measured power bond is invalid (see PowerBond).
  StepControl(const ResolvedSystem& system, SlaveSteps& slaves, const OverrideSchedule* overrides);

  /// Performs one communication step from t_k and sets `reached` to its end. If the error exceeds the tolerance and all
  /// slaves can restore their states, repeats the step with half the length. Returns and throws the same as
  /// Algorithm::step().
  std::optional<End> step(Algorithm& algorithm, std::int64_t k, std::int64_t& reached);

  const StepStatistics& statistics() const { return statistics_; }
  void visit(state::Visitor& v);

 private:
  /// The state of slaves and ensemble before a step. Excludes the state of step control.
  struct SavedPoint {
    std::vector<std::unique_ptr<SlaveState>> slaves;
    std::vector<std::byte> values;
  };

  SavedPoint save() const;
  void restore(const SavedPoint& saved, std::int64_t k);
  Point point(std::int64_t k) const { return {k, slaves_->time_ns(k)}; }
  void count(std::int64_t steps, const CouplingMeasure::Error& error);

  const StepControlDescription* description_;
  SlaveSteps* slaves_;
  bool rolls_back_;
  StepSizeController controller_;
  CouplingMeasure measure_;
  ForcedPoints forced_;
  bool begun_ = false;
  StepStatistics statistics_;
};

}  // namespace mebots::master
