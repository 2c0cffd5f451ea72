// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"
#include "model/run_course.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace mebots::master {

/// Follows a run: records it, judges it, shows it. Reads values through the ensemble that it was made with.
class Observer {
 public:
  virtual ~Observer() = default;

  /// Called at t = 0 and after every communication step. A text asks for the run to end here, and says why.
  virtual std::optional<std::string> reached(const Point& point) = 0;
  /// The run ends at `point`, which was reached. Not called when it fails.
  virtual void ended(const Point& /*point*/) {}

  /// Shows what an observer must remember to go on from a saved state.
  virtual void visit(state::Visitor& /*v*/) {}
  /// Under which name; empty for one that remembers nothing, which may come and go between the parts of a run.
  virtual std::string_view state_name() const { return {}; }
};

}  // namespace mebots::master
