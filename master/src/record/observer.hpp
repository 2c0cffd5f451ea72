// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"
#include "model/run_course.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace mebots::master {

/// Observes a run, for example to record values. An observer reads values from the ensemble that its constructor
/// received.
class Observer {
 public:
  virtual ~Observer() = default;

  /// Called at the start and after each communication step. To end the run at this point, returns the reason.
  virtual std::optional<std::string> reached(const Point& /*point*/) { return std::nullopt; }
  /// Called after reached() of all observers, unless the run ends at this point.
  virtual void continues(const Point& /*point*/) {}
  /// Called when the run ends at `point`. Not called if the run fails.
  virtual void ended(const Point& /*point*/) {}

  /// Visits the state that a resumed run needs.
  virtual void visit(state::Visitor& /*v*/) {}
  /// Returns the name of the observer's state in a checkpoint; an empty name if the observer has no state. An observer
  /// without a state may be missing in the run that resumes from the checkpoint.
  virtual std::string_view state_name() const { return {}; }
};

}  // namespace mebots::master
