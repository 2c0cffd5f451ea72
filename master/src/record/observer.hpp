// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"
#include "model/run_course.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace mebots::master {

/// Observes a run, for example to record it or to evaluate conditions. An observer reads values through the ensemble
/// that its constructor received.
class Observer {
 public:
  virtual ~Observer() = default;

  /// Called at t = 0 and after every communication step. If it returns a text, the run ends at this point, and the text
  /// is the reason.
  virtual std::optional<std::string> reached(const Point& /*point*/) { return std::nullopt; }
  /// Called at t = 0 and after every communication step, after reached() of all observers. Not called if the run ends
  /// at this point.
  virtual void continues(const Point& /*point*/) {}
  /// Called when the run ends at `point`. Not called if the run fails.
  virtual void ended(const Point& /*point*/) {}

  /// Visits the part of the observer's state that is saved and that a resumed run needs.
  virtual void visit(state::Visitor& /*v*/) {}
  /// Returns the name under which the observer's state is saved. Returns an empty name if there is no state; such an
  /// observer may be absent in a resumed run.
  virtual std::string_view state_name() const { return {}; }
};

}  // namespace mebots::master
