// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"
#include "model/step_control_description.hpp"

#include <cstdint>

namespace mebots::master {

/// A PI controller that chooses the length of the next step from the errors of the last two steps, as in ECCO.
/// Multiplies the length of the last step by safety * e^-(kI + kP) * e_before^kP, and limits the factor and the length.
/// e is the error of the last step, e_before the error of the step before it, both relative to their limits. Lengths
/// are in intervals of the grid. The gains apply to errors that are proportional to the square of the step length. For
/// a power p, e is the error to the power 2 / p.
class StepSizeController {
 public:
  /// `description` must outlive the controller.
  explicit StepSizeController(const StepControlDescription& description);

  /// Returns the length of the next step, which is at most `limit`. If one step would not reach `limit` and two steps
  /// would pass it, returns half of `limit`.
  std::int64_t next(std::int64_t limit) const;
  struct Step {
    std::int64_t length = 0;
    double error = 0;
    int order = 2;              ///< the error is proportional to this power of the length
    bool was_repeated = false;  ///< true if the step was repeated; then the next step must not be longer
  };
  void accept(const Step& step);
  /// Restarts with the initial step length. Must be called after a jump of variables.
  void restart();

  void visit(state::Visitor& v);

 private:
  const StepControlDescription* description_;
  double wanted_;  // not rounded, so that factors near 1 accumulate
  double error_before_ = 1;
};

}  // namespace mebots::master
