// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"
#include "model/step_control_description.hpp"

#include <cstdint>

namespace mebots::master {

/// Chooses the length of the next step from the errors of the last two: a PI controller as in ECCO. The next step is
/// the last one times safety * e^-(kI + kP) * e_before^kP, within the limits of the factor and of the step. Errors are
/// over their tolerance; lengths are in steps of the grid. The gains are for errors that grow with the square of the
/// step. Of one that grows with another power p, e is the power 2 / p.
class StepSizeController {
 public:
  /// The description must outlive the controller.
  explicit StepSizeController(const StepControlDescription& description);

  /// The length of the next step, at most `limit`: the way to a point that must not be passed. Divides that way in two
  /// if one step does not reach the point and two would pass it.
  std::int64_t next(std::int64_t limit) const;
  /// How a step ended.
  struct Step {
    std::int64_t length = 0;
    double error = 0;
    int order = 2;              ///< with which power of the length the error grows
    bool was_repeated = false;  ///< if so, the next one is not longer
  };
  void accept(const Step& step);
  /// Begins anew with the initial step, as after a jump.
  void restart();

  void visit(state::Visitor& v);

 private:
  const StepControlDescription* description_;
  double wanted_;  // not rounded, so that factors near 1 add up
  double error_before_ = 1;
};

}  // namespace mebots::master
