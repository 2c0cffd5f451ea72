// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/ensemble.hpp"
#include "record/observer.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace mebots::master {

/// A condition on the values at a communication point. Compares a variable with a value, or combines several conditions
/// (all, any, or a count).
class Condition {
 public:
  /// Throws InputError if the variable is unknown or the value does not match the variable's type.
  Condition(const ResolvedSystem& system, Ensemble& ensemble, const ConditionDescription& description);

  /// True if the condition is true now. If the description sets `ever`, true if the condition was true in any call of
  /// note_point().
  bool holds() const { return ever_ ? held_ : holds_now(); }
  /// Evaluates a condition with `ever` at the current point. Must be called at each communication point.
  void note_point();
  /// Returns a text such as "world.drone.landed = true".
  const std::string& text() const { return text_; }
  void visit(state::Visitor& v);

 private:
  void compare_variable(const ResolvedSystem& system, Ensemble& ensemble, const ConditionDescription& description);
  void count_members(const ResolvedSystem& system, Ensemble& ensemble, const ConditionDescription& description);
  bool holds_now() const;
  bool compares(double value) const;

  const Ensemble* ensemble_;
  Quantifier quantifier_;
  std::vector<Condition> members_;  // conditions to which the quantifier applies
  bool ever_;
  bool held_ = false;
  SignalId signal_;
  Comparison comparison_;
  double number_ = 0;       // compared number for Reals and Booleans (0 and 1), and for `above` and `below` of integers
  std::int64_t whole_ = 0;  // compared number for `equals` of integers and enumerations
  modeldesc::Type type_ = modeldesc::Type::real;
  std::string string_;
  std::string text_;
};

/// Ends a run when a condition has been true for the required duration.
class StopConditions final : public Observer {
 public:
  StopConditions(const ResolvedSystem& system, Ensemble& ensemble);

  std::optional<std::string> reached(const Point& point) override;
  void visit(state::Visitor& v) override;
  std::string_view state_name() const override { return "stop_conditions"; }

 private:
  struct Watch {
    Condition condition;
    std::int64_t for_ns;
    std::optional<std::int64_t> since_ns = {};  // time at which the condition became true; nullopt while it is false

    void visit(state::Visitor& v) { v("since_ns", since_ns); }
  };

  TimeGrid grid_;
  std::vector<Watch> watches_;
};

/// Determines the outcome of a run. The outcome is the first one in the config whose conditions are all true, or
/// "completed".
class Outcomes final : public Observer {
 public:
  Outcomes(const ResolvedSystem& system, Ensemble& ensemble);

  std::optional<std::string> reached(const Point& point) override;
  void visit(state::Visitor& v) override;
  std::string_view state_name() const override { return "outcomes"; }

  /// Returns the outcome at the last communication point.
  std::string outcome() const;

 private:
  struct Rule {
    std::string outcome;
    std::vector<Condition> when;

    void visit(state::Visitor& v) { v("when", std::span(when)); }
  };

  std::vector<Rule> rules_;
};

}  // namespace mebots::master
