// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/ensemble.hpp"
#include "model/override_schedule.hpp"
#include "record/conditions.hpp"
#include "record/observer.hpp"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace mebots::master {

/// Starts overrides when their conditions become true. A started override affects inputs from this communication point
/// and outputs from the next one.
class Scenario final : public Observer {
 public:
  /// Throws InputError if an override is invalid (see OverrideSchedule).
  explicit Scenario(const ResolvedSystem& system);

  /// Looks up the variables in the conditions. Must be called before the ensemble is initialised.
  void watch(const ResolvedSystem& system, Ensemble& ensemble);

  const OverrideSchedule& schedule() const { return schedule_; }

  std::optional<std::string> reached(const Point& point) override;
  void visit(state::Visitor& v) override;
  std::string_view state_name() const override { return "scenario"; }

  /// Returns the overrides and the times of their effect for summary.json. `end_ns` is the last communication point of
  /// the run.
  nlohmann::ordered_json report(const ResolvedSystem& system, std::int64_t end_ns) const;

 private:
  struct Trigger {
    std::optional<Condition> condition;
    std::optional<std::int64_t> holds_since_ns;

    void visit(state::Visitor& v) { v("holds_since_ns", holds_since_ns); }
  };

  OverrideSchedule schedule_;
  std::vector<Trigger> triggers_;  // indexed by override
};

}  // namespace mebots::master
