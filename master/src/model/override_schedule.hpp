// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/time_grid.hpp"
#include "mebots/state/visitor.hpp"
#include "model/resolved_system.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace mebots::master {

/// A checked override of a variable.
struct Override {
  const OverrideDescription* description = nullptr;
  ResolvedVariable variable;
  std::optional<modeldesc::Value> value;  ///< for `set`
  std::shared_ptr<const Signal> signal;   ///< for `signal`
};

/// The overrides of a system and the times at which they are active. The first overrides are the columns of the section
/// `inputs`, which are always active.
class OverrideSchedule {
 public:
  /// Throws InputError for unknown variables, for variables that cannot be overridden, and for values of the wrong type
  /// or unit.
  explicit OverrideSchedule(const ResolvedSystem& system);

  const std::vector<Override>& overrides() const { return overrides_; }
  /// Returns the number of overrides that come from the section `inputs`.
  std::size_t inputs() const { return inputs_; }
  /// Returns the start of the run.
  std::int64_t start_ns() const { return start_ns_; }
  const TimeGrid& grid() const { return grid_; }
  /// Returns the time at which an override begins, if this time is known.
  std::optional<std::int64_t> begin_of(std::size_t override) const;
  /// Returns the time since which an override has been active; empty if it is not active at this time.
  std::optional<std::int64_t> since(std::size_t override, std::int64_t time_ns) const;

  /// Starts an override. Called when the override's condition has been true for its duration.
  void start(std::size_t override, std::int64_t time_ns) { started_ns_[override] = time_ns; }
  void visit(state::Visitor& v) { v("started_ns", started_ns_); }

 private:
  std::int64_t start_ns_;
  TimeGrid grid_;
  std::size_t inputs_;
  std::vector<Override> overrides_;
  std::vector<std::optional<std::int64_t>> started_ns_;  // of overrides with a condition
};

/// Returns a readable text such as "offset 3".
std::string action_text(const OverrideDescription& override);

}  // namespace mebots::master
