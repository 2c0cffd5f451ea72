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

/// An override whose variable was found and checked.
struct Override {
  const OverrideDescription* description = nullptr;
  ResolvedVariable variable;
  std::optional<modeldesc::Value> value;  ///< value for the action `set`
  std::shared_ptr<const Signal> signal;   ///< values for the action `signal`
};

/// The overrides of a system, and the times at which they are active. The first inputs() overrides come from the
/// section `inputs` of the config. They are always active.
class OverrideSchedule {
 public:
  /// Throws InputError if a variable is unknown or cannot be overridden, or if a value has the wrong type or unit.
  explicit OverrideSchedule(const ResolvedSystem& system);

  const std::vector<Override>& overrides() const { return overrides_; }
  std::size_t inputs() const { return inputs_; }
  std::int64_t start_ns() const { return start_ns_; }
  const TimeGrid& grid() const { return grid_; }
  /// Returns the start time of an override; nullopt if its start depends on a condition that has not been true yet.
  std::optional<std::int64_t> begin_of(std::size_t override) const;
  /// Returns the start time of an override; nullopt if the override is not active at `time_ns`.
  std::optional<std::int64_t> since(std::size_t override, std::int64_t time_ns) const;

  /// Starts an override whose condition has been true for its duration.
  void start(std::size_t override, std::int64_t time_ns) { started_ns_[override] = time_ns; }
  void visit(state::Visitor& v) { v("started_ns", started_ns_); }

 private:
  std::int64_t start_ns_;
  TimeGrid grid_;
  std::size_t inputs_;
  std::vector<Override> overrides_;
  std::vector<std::optional<std::int64_t>> started_ns_;  // start times of overrides with a condition
};

/// Describes the action of an override, such as "offset 3".
std::string action_text(const OverrideDescription& override);

}  // namespace mebots::master
