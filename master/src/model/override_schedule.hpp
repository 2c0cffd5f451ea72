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

/// One override of a variable, checked.
struct Override {
  const OverrideDescription* description = nullptr;
  ResolvedVariable variable;
  std::optional<modeldesc::Value> value;  ///< for `set`
  std::shared_ptr<const Signal> signal;   ///< for `signal`
};

/// The overrides of a system, and the times at which each acts. The columns of `inputs` come first, as overrides that
/// always act.
class OverrideSchedule {
 public:
  /// Throws InputError for unknown variables, those that cannot be overridden, and values of the wrong type or unit.
  explicit OverrideSchedule(const ResolvedSystem& system);

  const std::vector<Override>& overrides() const { return overrides_; }
  /// The number of overrides that come from `inputs`.
  std::size_t inputs() const { return inputs_; }
  /// The start of the run.
  std::int64_t start_ns() const { return start_ns_; }
  const TimeGrid& grid() const { return grid_; }
  /// Returns when an override begins, if that is known.
  std::optional<std::int64_t> begin_of(std::size_t override) const;
  /// Returns the time since which an override acts, if it acts at this time.
  std::optional<std::int64_t> since(std::size_t override, std::int64_t time_ns) const;

  /// The condition of an override held for its time: the override begins.
  void start(std::size_t override, std::int64_t time_ns) { started_ns_[override] = time_ns; }
  void visit(state::Visitor& v) { v("started_ns", started_ns_); }

 private:
  std::int64_t start_ns_;
  TimeGrid grid_;
  std::size_t inputs_;
  std::vector<Override> overrides_;
  std::vector<std::optional<std::int64_t>> started_ns_;  // of those with a condition
};

/// "offset 3", for people.
std::string action_text(const OverrideDescription& override);

}  // namespace mebots::master
