// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"
#include "model/step_control_description.hpp"

#include <cstdint>

namespace mebots::master {

/// Chooses the length of the next step from the errors of the last two steps by a PI controller, as in ECCO. Multiplies
/// the length of the last step by safety * e^-(kI + kP) * e_before^kP, within the limits of the factor and of the step.
/// Here, e is the error of the last step, and e_before is the error of the step before it. Both errors are relative to
/// their limits. Lengths are in steps of the grid. The gains apply to errors that are proportional to the square of the
/// step. If an error is proportional to another power p of the step, e is the error to the power 2 / p.
class StepSizeController {
 public:
  /// The description must outlive the controller.
  explicit StepSizeController(const StepControlDescription& description);

  /// Returns the length of the next step. It is at most `limit`, the distance to a point that the step must not pass.
  /// If one step would not reach this point and two steps would pass it, returns half of the distance.
  std::int64_t next(std::int64_t limit) const;
  /// Describes a completed step.
  struct Step {
    std::int64_t length = 0;
    double error = 0;
    int order = 2;              ///< the error grows with this power of the length
    bool was_repeated = false;  ///< true if the step was repeated; then the next step is not longer
  };
  void accept(const Step& step);
  /// Restarts with the initial step. Must be called after a jump of variables.
  void restart();

  void visit(state::Visitor& v);

 private:
  const StepControlDescription* description_;
  double wanted_;  // not rounded, so that factors near 1 accumulate over several steps
  double error_before_ = 1;
};

}  // namespace mebots::master
