// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/ensemble.hpp"
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

/// One override of a variable, checked.
struct Override {
  const OverrideDescription* description = nullptr;
  ResolvedVariable variable;
  std::optional<modeldesc::Value> value;  ///< for `set`
  std::shared_ptr<const Signal> signal;   ///< for `signal`
};

/// Which overrides act when. The columns of `inputs` come first, as overrides that always act. Slaves whose variables
/// are overridden ask it (see OverriddenSlave); as an observer it finds the moments at which conditions hold. Such an
/// override acts on inputs from that communication point on, and on outputs from the next one.
class Scenario final : public Observer {
 public:
  /// Throws InputError for unknown variables, those that cannot be overridden, and values of the wrong type or unit.
  explicit Scenario(const ResolvedSystem& system);

  /// Looks the conditions' variables up. Before the ensemble is initialised.
  void watch(const ResolvedSystem& system, Ensemble& ensemble);

  const std::vector<Override>& overrides() const { return overrides_; }
  /// The start of the run.
  std::int64_t start_ns() const { return start_ns_; }
  const TimeGrid& grid() const { return grid_; }
  /// Since when an override acts, if it does at this time.
  std::optional<std::int64_t> since(std::size_t override, std::int64_t time_ns) const;

  std::optional<std::string> reached(const Point& point) override;
  void visit(state::Visitor& v) override;
  std::string_view state_name() const override { return "scenario"; }

  /// What acted when, for summary.json; `end_ns` is the last point reached.
  nlohmann::ordered_json report(const ResolvedSystem& system, std::int64_t end_ns) const;

 private:
  struct Trigger {
    std::optional<Condition> condition;
    std::optional<std::int64_t> holds_since_ns;
    std::optional<std::int64_t> started_ns;

    void visit(state::Visitor& v) {
      v("holds_since_ns", holds_since_ns);
      v("started_ns", started_ns);
    }
  };

  /// When an override begins, if that is known.
  std::optional<std::int64_t> begin_of(std::size_t override) const;

  std::int64_t start_ns_;
  TimeGrid grid_;
  std::size_t inputs_;  // so many overrides come from `inputs`
  std::vector<Override> overrides_;
  std::vector<Trigger> triggers_;  // one per override; without a condition where there is none
};

/// "offset 3", for people.
std::string action_text(const OverrideDescription& override);

}  // namespace mebots::master
